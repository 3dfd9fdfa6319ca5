#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "abbe/compensate/program/word_axes.h"
#include "abbe/formats/nc/nc_program.h"
#include "abbe/machine/inverse_plan.h"
#include "abbe/machine/machine.h"
#include "abbe/report/words/program_words.h"

namespace abbe {

// Settings of a ProgramRequest as people give them. Messages name the options of `abbe compensate gcode`.

/// Axes of the program's words: by the letters of their names, unless `texts` gives another, such as "C1=C".
/// @param machine_file  for messages
/// @throws InputError if an axis does not exist or has a word of another kind, and if no axis has a word
WordAxes program_word_axes(const Machine& machine, const std::vector<std::string>& texts,
                           const std::string& machine_file = "");

/// The axis of a word, "X", "C": its index in the machine. @param text  what was given, for messages: "X_mm=100"
/// @throws InputError if no axis has it
std::size_t axis_of_word(const WordAxes& words, const std::string& word, const std::string& text);

/// States where an axis stands when the program begins.
/// @param tool_centre  X Y Z are not positions of axes and may lie outside the travel of these
/// @param text         what was given, for messages
/// @throws InputError if the position lies outside the axis's travel
void set_program_start(const Machine& machine, const WordAxes& words, const HeldAxis& start, bool tool_centre,
                       const std::string& text, NcProgramOptions& options);

/// Problems by their names, "not-covered" and so on. @throws InputError for another name
AllowedProblems allowed_problems(std::span<const std::string> names);

/// Limits that every useful program keeps. @param size  of the program, bytes
ProgramLimits default_program_limits(std::size_t size);

}  // namespace abbe
