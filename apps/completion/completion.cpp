#include "completion/completion.h"

namespace abbe {
namespace {

void collect(const std::string& words, const CommandDescription& command, std::vector<TypedCommand>& result) {
  result.push_back({words, &command});
  for (const CommandDescription& one : command.subcommands) collect(words + " " + one.name, one, result);
}

}  // namespace

std::vector<TypedCommand> all_commands(const CommandDescription& program) {
  std::vector<TypedCommand> result;
  collect(program.name, program, result);
  return result;
}

std::string quoted_for_shell(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') {
      result += "'\\''";
    } else {
      result += c;
    }
  }
  return result + "'";
}

}  // namespace abbe
