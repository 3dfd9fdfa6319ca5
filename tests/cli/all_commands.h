#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "cli/run_command.h"

namespace abbe {

/// A command, as it is typed behind `abbe`, and what its --help says.
struct CommandWithHelp {
  std::vector<std::string> words;
  std::string help;
};

/// The program itself, its subcommands and theirs, as the helps list them.
/// @param run  runs `abbe` with arguments
inline std::vector<CommandWithHelp> all_commands(
    const std::function<CommandResult(const std::vector<std::string>&)>& run,
    const std::vector<std::string>& from = {}) {
  const std::set<std::string> sections = {"Subcommands:", "Whole studies:", "Machines:", "Measure:", "Identify:",
                                          "Evaluate:",    "Compensate:",    "Verify:",   "Shapes:"};
  std::vector<std::string> arguments = from;
  arguments.emplace_back("--help");
  const CommandResult help = run(arguments);
  EXPECT_EQ(help.exit_code, 0) << help.err;
  std::vector<CommandWithHelp> result{{from, help.out}};
  std::istringstream stream(help.out);
  bool below = false;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] != ' ') below = sections.contains(line);
    if (!below || line.size() < 3 || line[2] == ' ' || line[0] != ' ') continue;
    std::vector<std::string> deeper = from;
    deeper.push_back(line.substr(2, line.find(' ', 2) - 2));
    for (CommandWithHelp& one : all_commands(run, deeper)) result.push_back(std::move(one));
  }
  return result;
}

}  // namespace abbe
