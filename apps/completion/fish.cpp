#include <fmt/format.h>
#include <fmt/ranges.h>

#include "completion/completion.h"

namespace abbe {
namespace {

/// fish reads backslashes in single quotes as well.
std::string quoted_for_fish(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') result += '\\';
    result += c;
  }
  return result + "'";
}

/// What `complete` says of a value: its words, files or nothing.
std::string fish_value(const OptionDescription& option) {
  if (!option.words.empty()) return " -x -a " + quoted_for_fish(fmt::format("{}", fmt::join(option.words, " ")));
  return option.may_be_file() ? " -r -F" : " -x";
}

std::string lines_of(const TypedCommand& one) {
  const std::string start = fmt::format("complete -c abbe -n '__abbe_is \"{}\"'", one.words);
  std::string text;
  for (const CommandDescription& subcommand : one.command->subcommands) {
    text += fmt::format("{} -a {} -d {}\n", start, subcommand.name, quoted_for_fish(subcommand.description));
  }
  for (const OptionDescription& argument : one.command->arguments) {
    if (!argument.words.empty()) {
      text += fmt::format("{} -a {}\n", start, quoted_for_fish(fmt::format("{}", fmt::join(argument.words, " "))));
    } else if (argument.may_be_file()) {
      text += start + " -F\n";
    }
  }
  for (const OptionDescription& option : one.command->options) {
    text += start;
    for (const std::string& name : option.names) {
      text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    }
    text +=
        fmt::format("{} -d {}\n", option.takes_value() ? fish_value(option) : "", quoted_for_fish(option.description));
  }
  return text;
}

}  // namespace

std::string fish_completion(const CommandDescription& program) {
  const std::vector<TypedCommand> commands = all_commands(program);
  std::string known;
  for (std::size_t k = 1; k < commands.size(); ++k) known += fmt::format(" '{}'", commands[k].words);
  std::string text = fmt::format(R"(# fish completion for abbe, made by `abbe completion fish`

# Whether the words typed so far name this command.
function __abbe_is
    set -l command abbe
    for word in (commandline -opc)[2..-1]
        switch "$command $word"
            case{}
                set command "$command $word"
        end
    end
    test "$command" = "$argv[1]"
end

complete -c abbe -f
)",
                                 known);
  for (const TypedCommand& one : commands) text += lines_of(one);
  return text;
}

}  // namespace abbe
