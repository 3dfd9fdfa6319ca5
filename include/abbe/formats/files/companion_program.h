#pragma once

// For formats and the command: programs that come with this one, such as abbe-step.
#include <filesystem>

#include "abbe/formats/text/input_error.h"

namespace abbe {

/// A program that comes with the running one and is installed beside it.
struct CompanionProgram {
  const char* name;      ///< "abbe-step"
  const char* variable;  ///< of the environment; it names another program to run instead: "ABBE_STEP_PROGRAM"
};

/// Where it belongs: the folder of the running program, and its name.
std::filesystem::path path_beside_this_program(const CompanionProgram& program);

/// The program to run: the value of the variable where that is set and not empty, else what is beside this program;
/// empty if nothing there can be run.
/// @param place  of what needs it, for the error
/// @throws InputError if the variable names what is no program
std::filesystem::path find_companion_program(const CompanionProgram& program, const InputError::Place& place = {});

}  // namespace abbe
