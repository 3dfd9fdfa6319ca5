#pragma once

#include <functional>

#include "command.h"

namespace abbe {

/// What main() of a program with the command line of `abbe` does: standard streams and signals are set up, the command
/// line is parsed and run, and what went wrong is said after "abbe: ". A program calls it once and returns its value.
/// @param argv             of main()
/// @param add_subcommands  adds the subcommands that the program knows
/// @returns an ExitCode
int command_main(int argc, const char* const* argv, const std::function<void(CommandLine&)>& add_subcommands);

}  // namespace abbe
