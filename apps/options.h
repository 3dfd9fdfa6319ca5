#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command_description.h"

// The parser takes seconds to compile; options.cpp alone includes it.
namespace CLI {  // NOLINT(readability-identifier-naming): the name is the parser's
class App;
class Option;
}  // namespace CLI

namespace abbe {

/// What the text of a value has to fulfil.
struct Check {
  std::function<std::string(const std::string& text)> problem;  ///< what is wrong with a text; empty: nothing
  std::string description;                                      ///< for --help, behind the type: "INT from 0 to 9"
  std::vector<std::string> words{};                             ///< all texts that fulfil it, if they can be listed
};

/// A number from one end to the other, both included, of the type of the ends.
Check in_range(int from, int to);
Check in_range(double from, double to);
Check positive_number();
Check non_negative_number();
/// One of these words.
Check one_of(const std::vector<std::string>& words);

/// An option or a positional argument; it belongs to its subcommand. What changes it returns it, so that calls chain.
class Option {
  friend class Subcommand;

 public:
  explicit Option(CLI::Option& option) : option_(&option) {}

  Option* required();
  Option* check(const Check& check);
  /// So many values each time it is given.
  Option* expected(int values);
  /// Given again, it adds to its values.
  Option* take_all();
  /// Whether values may follow the first; without, they are positional arguments.
  Option* allow_extra_args(bool allowed);
  /// --help shows what the variable holds now.
  Option* capture_default_str();
  /// Words that shells offer for its value; others may be right too.
  Option* suggest(const std::vector<std::string>& words);
  /// In place of TEXT, FLOAT and the like in --help.
  Option* type_name(const std::string& name);
  /// Heading in --help under which it stands.
  Option* group(const std::string& heading);
  /// It cannot be given together with an option that exists already.
  Option* excludes(const std::string& name);
  /// It can only be given together with an option that exists already.
  Option* needs(const std::string& name);

  /// How often it was given.
  std::size_t count() const;
  /// "--output" of "-o,--output"; an argument's name as it is.
  std::string get_name() const;
  OptionDescription describe() const;
  bool is(const CLI::Option* option) const { return option == option_; }

 private:
  CLI::Option* option_;
  std::vector<std::string> words_;
};

/// A command with its options; it belongs to the program, or to the command that it is a part of.
class Subcommand {
 public:
  /// Adds --quiet, which every command has.
  explicit Subcommand(CLI::App& app);
  Subcommand(const Subcommand&) = delete;
  Subcommand& operator=(const Subcommand&) = delete;

  /// An option ("-o,--output") or a positional argument ("file").
  /// @param value  written when the command line is parsed, stays as it is if the option is not given; has to live on
  template <typename Value>  // one of those that options.cpp has
  Option* add_option(const std::string& name, Value& value, const std::string& description);
  /// @param take  is called with the text while the command line is parsed; what it throws comes out of
  /// Program::parse()
  Option* add_option_function(const std::string& name, const std::function<void(const std::string& text)>& take,
                              const std::string& description);
  /// An option without a value.
  Option* add_flag(const std::string& name, bool& value, const std::string& description);

  /// The name of a file that the command reads, or "-": standard input (abbe/formats/files/standard_input.h), whose
  /// name is in `value` when the command runs. Of all such names one at most may be "-".
  Option* add_input_file(const std::string& name, std::string& value, const std::string& description);
  Option* add_input_file(const std::string& name, std::vector<std::string>& value, const std::string& description);
  /// These options were arguments once, in front of all others. Where the command line has as many words, that is still
  /// understood; the new form is told.
  void take_from_arguments(const std::vector<Option*>& options);

  /// The name of a file that the command writes. Adds --force, without which a file that exists is not replaced
  /// (abbe/formats/files/existing_output.h); that is checked when the command line was parsed and again by the writer.
  /// @param not_written  if it is not null and true then, the file will not be written and its name is not checked
  Option* add_output_file(const std::string& name, std::string& value, const std::string& description,
                          const bool* not_written = nullptr);
  Option* add_output_file(const std::string& name, std::vector<std::string>& value, const std::string& description);
  /// The name of a folder of results, which may replace older results (abbe/formats/files/results_folder.h); that is
  /// checked when the command line was parsed.
  Option* add_output_folder(const std::string& name, std::string& value, const std::string& description);
  /// add_output_file() or add_output_folder(), by names_folder().
  Option* add_output_file_or_folder(const std::string& name, std::string& value, const std::string& description,
                                    const bool* not_written = nullptr);

  Subcommand* add_subcommand(const std::string& name, const std::string& description);
  /// How many subcommands have to be given.
  void require_subcommand(int count);
  void require_subcommand(std::size_t least, std::size_t most);
  /// What it does not know is looked for in the command that it is a part of.
  void fallthrough();
  /// Heading under which the help of the program lists it.
  void section(const std::string& heading);
  /// Text at the end of --help.
  void footer(const std::string& text);
  /// Called when the command line was parsed and names this command.
  void callback(const std::function<void()>& call);

  /// Whether the command line names this command.
  bool parsed() const;
  /// How often an option was given.
  std::size_t count(const std::string& option) const;
  /// Names of the options and arguments that were given, in the order in which they were added.
  std::vector<std::string> given_options() const;
  CommandDescription describe() const;

  /// For Program, of a command that the command line names: whether outputs may take the names they were given.
  /// @throws InputError
  void check_outputs() const;
  /// For Program as well: old forms are told, and standard input gets its name where a file is "-".
  /// @param options  those that name standard input are added
  void take_inputs(std::vector<std::string>& options);
  /// Whether --quiet is given, here or of a part of the command; and the same of --json.
  bool has_flag(const std::string& name) const;

 private:
  enum class OutputKind { file, folder, file_or_folder };
  struct Output {
    OutputKind kind;
    std::function<std::vector<std::string>()> names;
    const bool* not_written;
  };
  struct Input {
    const Option* option;
    std::function<std::vector<std::string*>()> names;
  };
  Option* add_output(const std::string& name, std::string& value, const std::string& description, OutputKind kind,
                     const bool* not_written);
  void add_force();
  Option* own(CLI::Option& option);

  CLI::App* app_;
  std::vector<std::unique_ptr<Option>> options_;
  std::vector<std::unique_ptr<Subcommand>> subcommands_;
  std::vector<Output> outputs_;
  std::vector<Input> inputs_;
  std::string old_form_;  ///< what should have been written
  bool has_force_ = false, force_ = false, quiet_ = false;
};

/// Tells that something is given in an old form. @param written  what should have been written: "--machine m.toml"
void tell_old_form(const std::string& written);

/// Whether the name of an output that may be a file or a folder is that of a folder: it ends in a slash, is a folder or
/// has no ending.
bool names_folder(const std::string& name);

/// How parsing a command line ended.
enum class ParseResult {
  command,  ///< everything is there to run the command
  shown,    ///< help or the version was wanted and is printed
  refused   ///< what is wrong is printed on standard error
};

/// The program as a whole: the options that belong to no subcommand, and the subcommands.
class Program {
 public:
  Program(const std::string& description, const std::string& name);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  Subcommand* add_subcommand(const std::string& name, const std::string& description);
  std::vector<std::string> subcommand_names() const;
  /// How many subcommands have to be given.
  void require_subcommand(int count);
  /// Text at the end of --help.
  void footer(const std::string& text);
  void set_version_flag(const std::string& name, const std::string& version);
  /// A flag for the help of all subcommands.
  void set_help_all_flag(const std::string& name, const std::string& description);
  /// What it understands; without the subcommands that --help does not list.
  CommandDescription describe() const;

  /// @throws InputError for an output whose name is not free, and what functions of options throw
  ParseResult parse(int argc, const char* const* argv);

 private:
  std::unique_ptr<CLI::App> app_;
  bool quiet_ = false;
  std::vector<std::unique_ptr<Subcommand>> subcommands_;
};

}  // namespace abbe
