#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "completion/completion.h"

namespace abbe {
namespace {

/// What brackets of a specification of _arguments hold, or what stands between its colons.
std::string escaped_for_arguments(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
    result += c;
  }
  return result;
}

std::string function_name(std::string words) {
  std::replace(words.begin(), words.end(), ' ', '_');
  return "_" + words;
}

/// ":TEXT:_files", and the like.
std::string value_of(const OptionDescription& option) {
  const std::string message = escaped_for_arguments(option.names.empty() ? option.argument : option.type);
  const std::string action = !option.words.empty()  ? fmt::format("({})", fmt::join(option.words, " "))
                             : option.may_be_file() ? "_files"
                                                    : " ";
  return fmt::format(":{}:{}", message, action);
}

std::string option_line(const OptionDescription& option) {
  const std::string rest = quoted_for_shell("[" + escaped_for_arguments(option.description) + "]" +
                                            (option.takes_value() ? value_of(option) : ""));
  const std::string names = fmt::format("{}", fmt::join(option.names, ","));
  if (option.repeatable) {
    const std::string each = option.names.size() > 1 ? "{" + names + "}" : names;
    return fmt::format("'*'{}{}", each, rest);
  }
  if (option.names.size() == 1) return names + rest;
  return fmt::format("'({})'{{{}}}{}", fmt::join(option.names, " "), names, rest);
}

std::string function_of(const TypedCommand& one) {
  const CommandDescription& command = *one.command;
  std::string text = fmt::format("{}() {{\n", function_name(one.words));
  if (!command.subcommands.empty()) {
    text += "  local state line\n  typeset -A opt_args\n  local -a commands=(\n";
    for (const CommandDescription& subcommand : command.subcommands) {
      text += fmt::format("    {}\n", quoted_for_shell(subcommand.name + ":" + subcommand.description));
    }
    text += "  )\n";
  }
  text += command.subcommands.empty() ? "  _arguments" : "  _arguments -C";
  for (const OptionDescription& option : command.options) text += " \\\n    " + option_line(option);
  for (const OptionDescription& argument : command.arguments) {
    text += " \\\n    " + quoted_for_shell((argument.repeatable ? "*" : "") + value_of(argument));
  }
  if (command.subcommands.empty()) return text + "\n}\n\n";
  text += " \\\n    '1: :->command' '*:: :->rest'\n  case $state in\n    command) _describe command commands ;;\n";
  text += "    rest)\n      case $line[1] in\n";
  for (const CommandDescription& subcommand : command.subcommands) {
    text += fmt::format("        {}) {} ;;\n", subcommand.name, function_name(one.words + " " + subcommand.name));
  }
  return text + "      esac ;;\n  esac\n}\n\n";
}

}  // namespace

std::string zsh_completion(const CommandDescription& program) {
  std::string text = "#compdef abbe\n# zsh completion for abbe, made by `abbe completion zsh`\n\n";
  for (const TypedCommand& one : all_commands(program)) text += function_of(one);
  // Loaded by the completion system this file is the body of the function that it calls; otherwise it registers it.
  return text + "if [ \"$funcstack[1]\" = _abbe ]; then\n  _abbe \"$@\"\nelse\n  compdef _abbe abbe\nfi\n";
}

}  // namespace abbe
