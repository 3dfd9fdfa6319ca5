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

// Settings of a ProgramRequest as users state them. Messages name the options of `abbe compensate gcode`.

/// The axes that the program's words move: those of the same name, unless `texts` states another word, as in "C1=C".
/// @param machine_file  for messages
/// @throws InputError if an axis does not exist, if its word is for the other kind of axis, and if no axis has a word
WordAxes program_word_axes(const Machine& machine, const std::vector<std::string>& texts,
                           const std::string& machine_file = "");

/// The axis that a word, such as "C", moves: its index in the machine.
/// @param text  what the user stated, for messages: "X_mm=100"
/// @throws InputError if no axis has that word
std::size_t axis_of_word(const WordAxes& words, const std::string& word, const std::string& text);

/// Sets where an axis stands when the program begins.
/// @param start        its index and its position, mm or rad
/// @param tool_centre  X Y Z are the functional point, which may lie outside the travel of the axes X Y Z
/// @param text         what the user stated, for messages: "X_mm=100"
/// @throws InputError if the position lies outside the axis's travel
void set_program_start(const Machine& machine, const WordAxes& words, const HeldAxis& start, bool tool_centre,
                       const std::string& text, NcProgramOptions& options);

/// Problems by their names for --allow, such as "not-covered". @throws InputError for any other name
AllowedProblems allowed_problems(std::span<const std::string> names);

/// Default limits; any useful program stays within them. @param size  of the program, bytes
ProgramLimits default_program_limits(std::size_t size);

}  // namespace abbe
