#include <fmt/format.h>
#include <fmt/ranges.h>

#include "completion/completion.h"

namespace abbe {
namespace {

/// `"abbe run -o" | "abbe run --output"`, a pattern of a case of bash.
std::string pattern_of(const std::string& command, const OptionDescription& option) {
  std::string result;
  for (const std::string& name : option.names) {
    result += fmt::format("{}\"{} {}\"", result.empty() ? "" : " | ", command, name);
  }
  return result;
}

/// Cases for what comes behind an option with a value.
std::string cases_of_values(const std::vector<TypedCommand>& commands) {
  std::string result;
  for (const TypedCommand& one : commands) {
    for (const OptionDescription& option : one.command->options) {
      if (!option.takes_value()) continue;
      const std::string what = !option.words.empty()  ? fmt::format("_abbe_words '{}'", fmt::join(option.words, " "))
                               : option.may_be_file() ? "_abbe_files"
                                                      : ":";
      result += fmt::format("    {}) {}; return ;;\n", pattern_of(one.words, option), what);
    }
  }
  return result;
}

/// Cases for words that are no options: subcommands and positional arguments.
std::string cases_of_arguments(const std::vector<TypedCommand>& commands) {
  std::string result;
  for (const TypedCommand& one : commands) {
    std::vector<std::string> words;
    bool files = false;
    for (const CommandDescription& subcommand : one.command->subcommands) words.push_back(subcommand.name);
    for (const OptionDescription& argument : one.command->arguments) {
      words.insert(words.end(), argument.words.begin(), argument.words.end());
      files = files || argument.may_be_file();
    }
    std::string what = words.empty() ? "" : fmt::format("_abbe_words '{}'", fmt::join(words, " "));
    if (files) what += what.empty() ? "_abbe_files" : "; _abbe_files";
    if (!what.empty()) result += fmt::format("    \"{}\") {} ;;\n", one.words, what);
  }
  return result;
}

std::string cases_of_options(const std::vector<TypedCommand>& commands) {
  std::string result;
  for (const TypedCommand& one : commands) {
    std::vector<std::string> names;
    for (const OptionDescription& option : one.command->options) {
      names.insert(names.end(), option.names.begin(), option.names.end());
    }
    result += fmt::format("      \"{}\") _abbe_words '{}' ;;\n", one.words, fmt::join(names, " "));
  }
  return result;
}

std::string patterns_of_subcommands(const std::vector<TypedCommand>& commands) {
  std::string result;
  for (std::size_t k = 1; k < commands.size(); ++k) {
    result += fmt::format("{}\"{}\"", result.empty() ? "" : " | \\\n        ", commands[k].words);
  }
  return result;
}

}  // namespace

std::string bash_completion(const CommandDescription& program) {
  const std::vector<TypedCommand> commands = all_commands(program);
  return fmt::format(R"(# bash completion for abbe, made by `abbe completion bash`

_abbe_words() {{
  COMPREPLY+=($(compgen -W "$1" -- "$word"))
}}

_abbe_files() {{
  local name
  compopt -o filenames
  while IFS= read -r name; do COMPREPLY+=("$name"); done < <(compgen -f -- "$word")
}}

_abbe() {{
  local word="${{COMP_WORDS[COMP_CWORD]}}" before="${{COMP_WORDS[COMP_CWORD - 1]}}" command=abbe i
  COMPREPLY=()
  # --option=value comes as three words.
  if [ "$word" = "=" ]; then
    word=""
  elif [ "$before" = "=" ] && [ "$COMP_CWORD" -ge 2 ]; then
    before="${{COMP_WORDS[COMP_CWORD - 2]}}"
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$command ${{COMP_WORDS[i]}}" in
      {})
        command="$command ${{COMP_WORDS[i]}}" ;;
    esac
  done
  case "$command $before" in
{}  esac
  if [ "${{word:0:1}}" = "-" ]; then
    case "$command" in
{}    esac
    return
  fi
  case "$command" in
{}  esac
}}
complete -F _abbe abbe
)",
                     patterns_of_subcommands(commands), cases_of_values(commands), cases_of_options(commands),
                     cases_of_arguments(commands));
}

}  // namespace abbe
