#pragma once

#include <string>
#include <vector>

namespace abbe {

/// An option or a positional argument, as the parser knows it.
struct OptionDescription {
  std::vector<std::string> names;  ///< "-o", "--output"; empty for a positional argument
  std::string argument;            ///< name of a positional argument
  std::string description;
  std::string type;           ///< of its value, with what is checked: "TEXT", "INT:INT in [0 - 9]"; empty: it has none
  std::string default_value;  ///< as --help shows it; empty: it shows none
  std::vector<std::string> words{};  ///< words for its value, if they can be listed
  bool required = false;
  bool repeatable = false;  ///< it takes several values

  bool takes_value() const { return !type.empty(); }
  /// Whether a value is a text that no list of words limits: the name of a file, mostly.
  bool may_be_file() const { return words.empty() && type.starts_with("TEXT"); }
};

/// A command, as the parser knows it: of this the completions of shells and the man pages are made.
struct CommandDescription {
  std::string name;  ///< "table"
  std::string description;
  std::string section;  ///< heading under which the command that it is a part of lists it
  std::string footer;   ///< text at the end of --help
  std::vector<OptionDescription> arguments, options;
  std::vector<CommandDescription> subcommands;
};

}  // namespace abbe
