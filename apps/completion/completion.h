#pragma once

#include <string>
#include <vector>

#include "command_description.h"

namespace abbe {

/// Completion of the command line, as a script of a shell that needs nothing beside it: subcommands, options, words of
/// options, and names of files where a value may be one.
std::string bash_completion(const CommandDescription& program);
std::string zsh_completion(const CommandDescription& program);
std::string fish_completion(const CommandDescription& program);

/// A command with what is typed to get there: "abbe compensate table".
struct TypedCommand {
  std::string words;
  const CommandDescription* command;
};

/// The program and all commands below it, each behind the one that it is a part of.
std::vector<TypedCommand> all_commands(const CommandDescription& program);

/// In single quotes, as every shell reads it.
std::string quoted_for_shell(const std::string& text);

}  // namespace abbe
