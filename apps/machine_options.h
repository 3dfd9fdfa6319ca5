#pragma once

#include <string>

namespace abbe {

class Option;
class Subcommand;

// The machine and its errors are given in one way by all commands: as --machine FILE and --errors FILE. Arguments are
// what a command works on.

Option* add_machine(Subcommand& command, std::string& file,
                    const std::string& description = "Machine file (*.machine.toml)");
Option* add_errors(Subcommand& command, std::string& file,
                   const std::string& description = "Errors file (*.errors.toml)");

/// Both, required, of a command that had them as arguments once; to be called behind its own arguments.
void add_machine_and_errors(Subcommand& command, std::string& machine, std::string& errors);

}  // namespace abbe
