#include "options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <sstream>
#include <system_error>
#include <utility>

#include "abbe/formats/files/existing_output.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/text/input_error.h"
#include "messages.h"
#include "nearest_word.h"

namespace abbe {
namespace {

Check check_of(const CLI::Validator& validator) {
  return {[validator](const std::string& text) { return validator(text); }, validator.get_description()};
}

}  // namespace

Check in_range(int from, int to) { return check_of(CLI::Range(from, to)); }
Check in_range(double from, double to) { return check_of(CLI::Range(from, to)); }
Check positive_number() { return check_of(CLI::PositiveNumber); }
Check non_negative_number() { return check_of(CLI::NonNegativeNumber); }
Check one_of(const std::vector<std::string>& words) {
  Check check = check_of(CLI::IsMember(words));
  check.words = words;
  return check;
}

Option* Option::required() {
  option_->required();
  return this;
}

Option* Option::check(const Check& check) {
  option_->check(
      CLI::Validator([problem = check.problem](std::string& text) { return problem(text); }, check.description));
  if (!check.words.empty()) words_ = check.words;
  return this;
}

Option* Option::expected(int values) {
  option_->expected(values);
  return this;
}

Option* Option::take_all() {
  option_->take_all();
  return this;
}

Option* Option::allow_extra_args(bool allowed) {
  option_->allow_extra_args(allowed);
  return this;
}

Option* Option::capture_default_str() {
  option_->capture_default_str();
  return this;
}

Option* Option::suggest(const std::vector<std::string>& words) {
  words_ = words;
  return this;
}

Option* Option::type_name(const std::string& name) {
  option_->type_name(name);
  return this;
}

Option* Option::group(const std::string& heading) {
  option_->group(heading);
  return this;
}

Option* Option::excludes(const std::string& name) {
  option_->excludes(name);
  return this;
}

Option* Option::needs(const std::string& name) {
  option_->needs(name);
  return this;
}

std::size_t Option::count() const { return option_->count(); }
std::string Option::get_name() const { return option_->get_name(); }

namespace {

OptionDescription description_of(const CLI::Option& option) {
  OptionDescription result;
  for (const std::string& name : option.get_snames()) result.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) result.names.push_back("--" + name);
  if (option.get_positional()) result.argument = option.get_name(true);
  result.description = option.get_description();
  result.type = option.get_items_expected_max() == 0 ? "" : option.get_type_name();
  result.default_value = option.get_default_str();
  result.required = option.get_required();
  result.repeatable = option.get_expected_max() > 1;
  return result;
}

CommandDescription description_of(const CLI::App& app) {
  CommandDescription result;
  result.name = app.get_name();
  result.description = app.get_description();
  result.section = app.get_group();
  result.footer = app.get_footer();
  return result;
}

void add_description(CommandDescription& command, const OptionDescription& option) {
  (option.names.empty() ? command.arguments : command.options).push_back(option);
}

void add_descriptions(CommandDescription& command, const std::vector<std::unique_ptr<Subcommand>>& subcommands) {
  for (const std::unique_ptr<Subcommand>& one : subcommands) {
    CommandDescription description = one->describe();
    if (!description.section.empty()) command.subcommands.push_back(std::move(description));
  }
}

}  // namespace

OptionDescription Option::describe() const {
  OptionDescription result = description_of(*option_);
  result.words = words_;
  return result;
}

CommandDescription Subcommand::describe() const {
  CommandDescription result = description_of(*app_);
  for (const CLI::Option* const option : app_->get_options()) {
    const auto own = std::find_if(options_.begin(), options_.end(), [&](const auto& one) { return one->is(option); });
    add_description(result, own == options_.end() ? description_of(*option) : (*own)->describe());
  }
  add_descriptions(result, subcommands_);
  return result;
}

Option* Subcommand::own(CLI::Option& option) { return options_.emplace_back(std::make_unique<Option>(option)).get(); }

template <typename Value>
Option* Subcommand::add(const std::string& name, Value& value, const std::string& description) {
  return own(*app_->add_option(name, value, description));
}

Option* Subcommand::add_option(const std::string& name, std::string& value, const std::string& description) {
  return add(name, value, description);
}

Option* Subcommand::add_option(const std::string& name, double& value, const std::string& description) {
  return add(name, value, description);
}

Option* Subcommand::add_option(const std::string& name, int& value, const std::string& description) {
  return add(name, value, description);
}

Option* Subcommand::add_option(const std::string& name, unsigned& value, const std::string& description) {
  return add(name, value, description);
}

Option* Subcommand::add_option(const std::string& name, unsigned long& value, const std::string& description) {
  return add(name, value, description);
}

Option* Subcommand::add_option(const std::string& name, unsigned long long& value, const std::string& description) {
  return add(name, value, description);
}

Option* Subcommand::add_option(const std::string& name, std::optional<double>& value, const std::string& description) {
  return add(name, value, description);
}

Option* Subcommand::add_option(const std::string& name, std::optional<std::size_t>& value,
                               const std::string& description) {
  return add(name, value, description);
}

Option* Subcommand::add_option(const std::string& name, std::vector<std::string>& value,
                               const std::string& description) {
  return add(name, value, description);
}

Option* Subcommand::add_option(const std::string& name, std::vector<double>& value, const std::string& description) {
  return add(name, value, description);
}

Option* Subcommand::add_option(const std::string& name, std::vector<std::vector<double>>& value,
                               const std::string& description) {
  return add(name, value, description);
}

Option* Subcommand::add_option_function(const std::string& name,
                                        const std::function<void(const std::string& text)>& take,
                                        const std::string& description) {
  return own(*app_->add_option_function<std::string>(name, take, description));
}

Option* Subcommand::add_flag(const std::string& name, bool& value, const std::string& description) {
  return own(*app_->add_flag(name, value, description));
}

void Subcommand::add_force() {
  if (has_force_) return;
  has_force_ = true;
  add_flag("--force", force_, "Replace files that exist");
}

Option* Subcommand::add_output(const std::string& name, std::string& value, const std::string& description,
                               OutputKind kind, const bool* not_written) {
  Option* const option = add_option(name, value, description);
  if (kind != OutputKind::folder) add_force();
  outputs_.push_back({kind, [&value] { return std::vector<std::string>{value}; }, not_written});
  return option;
}

Option* Subcommand::add_output_file(const std::string& name, std::string& value, const std::string& description,
                                    const bool* not_written) {
  return add_output(name, value, description, OutputKind::file, not_written);
}

Option* Subcommand::add_output_file(const std::string& name, std::vector<std::string>& value,
                                    const std::string& description) {
  Option* const option = add_option(name, value, description);
  add_force();
  outputs_.push_back({OutputKind::file, [&value] { return value; }, nullptr});
  return option;
}

Option* Subcommand::add_output_folder(const std::string& name, std::string& value, const std::string& description) {
  return add_output(name, value, description, OutputKind::folder, nullptr);
}

Option* Subcommand::add_output_file_or_folder(const std::string& name, std::string& value,
                                              const std::string& description, const bool* not_written) {
  return add_output(name, value, description, OutputKind::file_or_folder, not_written);
}

bool names_folder(const std::string& name) {
  std::error_code ignored;
  return name.ends_with('/') || std::filesystem::is_directory(name, ignored) ||
         !std::filesystem::path(name).has_extension();
}

void Subcommand::check_outputs() const {
  if (force_) replace_existing_outputs();
  std::vector<std::filesystem::path> all, folders;
  for (const Output& output : outputs_) {
    if (output.not_written != nullptr && *output.not_written) continue;
    for (const std::string& name : output.names()) {
      if (name.empty()) continue;
      const std::filesystem::path place = std::filesystem::weakly_canonical(std::filesystem::absolute(name));
      if (output.kind == OutputKind::folder || (output.kind == OutputKind::file_or_folder && names_folder(name))) {
        check_results_folder(name);
        folders.push_back(place.filename().empty() ? place.parent_path() : place);
      } else if (std::find(folders.begin(), folders.end(), place.parent_path()) != folders.end()) {
        refuse_existing_output(name);  // its folder is made by this command
      } else {
        check_output_file(name);
      }
      if (std::find(all.begin(), all.end(), place) != all.end()) {
        throw InputError({.file = name}, "is the name of two outputs", "another name for one of them");
      }
      all.push_back(place);
    }
  }
  for (const std::unique_ptr<Subcommand>& subcommand : subcommands_) {
    if (subcommand->parsed()) subcommand->check_outputs();
  }
}

Subcommand* Subcommand::add_subcommand(const std::string& name, const std::string& description) {
  return subcommands_.emplace_back(std::make_unique<Subcommand>(*app_->add_subcommand(name, description))).get();
}

void Subcommand::require_subcommand(int count) { app_->require_subcommand(count); }
void Subcommand::require_subcommand(std::size_t least, std::size_t most) { app_->require_subcommand(least, most); }
void Subcommand::fallthrough() { app_->fallthrough(); }
void Subcommand::section(const std::string& heading) { app_->group(heading); }
void Subcommand::footer(const std::string& text) { app_->footer(text); }
void Subcommand::callback(const std::function<void()>& call) { app_->callback(call); }
bool Subcommand::parsed() const { return app_->parsed(); }
std::size_t Subcommand::count(const std::string& option) const { return app_->count(option); }

std::vector<std::string> Subcommand::given_options() const {
  std::vector<std::string> names;
  for (const CLI::Option* const option : app_->get_options()) {
    if (option->count() > 0) names.push_back(option->get_name());
  }
  return names;
}

Program::Program(const std::string& description, const std::string& name)
    : app_(std::make_unique<CLI::App>(description, name)) {}
Program::~Program() = default;

Subcommand* Program::add_subcommand(const std::string& name, const std::string& description) {
  return subcommands_.emplace_back(std::make_unique<Subcommand>(*app_->add_subcommand(name, description))).get();
}

namespace {

std::vector<std::string> subcommand_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* const one : app.get_subcommands([](const CLI::App* /*any*/) { return true; })) {
    names.push_back(one->get_name());
  }
  return names;
}

}  // namespace

std::vector<std::string> Program::subcommand_names() const { return abbe::subcommand_names(*app_); }

void Program::require_subcommand(int count) { app_->require_subcommand(count); }
void Program::footer(const std::string& text) { app_->footer(text); }

void Program::set_version_flag(const std::string& name, const std::string& version) {
  app_->set_version_flag(name, version);
}

void Program::set_help_all_flag(const std::string& name, const std::string& description) {
  app_->set_help_all_flag(name, description);
}

CommandDescription Program::describe() const {
  CommandDescription result = description_of(*app_);
  for (const CLI::Option* const option : app_->get_options()) add_description(result, description_of(*option));
  add_descriptions(result, subcommands_);
  return result;
}

namespace {

/// What was typed to get here: "abbe compensate table".
std::string words_of(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name() : words_of(*app.get_parent()) + " " + app.get_name();
}

/// The command that the command line names, as far as it was understood.
const CLI::App& innermost_command(const CLI::App& app) {
  const std::vector<CLI::App*> named = app.get_subcommands();
  return named.empty() ? app : innermost_command(*named.back());
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* const option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

/// What cannot be placed, and what may have been meant.
std::string unexpected_words(const CLI::App& program) {
  const CLI::App& command = innermost_command(program);
  const std::vector<std::string> extras = program.remaining(true);
  std::string text;
  for (const std::string& word : extras) {
    const bool is_option = word.starts_with('-') && word.size() > 1;
    const std::string name = is_option ? word.substr(0, word.find('=')) : word;
    const std::optional<std::string> meant =
        nearest_word(name, is_option ? option_names(command) : subcommand_names(command));
    text += fmt::format("abbe: '{}' is {} {}{}\n", name, is_option ? "not an option of" : "not expected by",
                        words_of(command), meant ? "; did you mean " + *meant + "?" : "");
  }
  return text + fmt::format("abbe: {} --help lists what there is\n", words_of(command));
}

}  // namespace

ParseResult Program::parse(int argc, const char* const* argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // What is missing is often there, but misspelled.
    const bool is_lack = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
    if ((is_lack || dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) && app_->remaining_size(true) > 0) {
      tell_text(unexpected_words(*app_));
      return ParseResult::refused;
    }
    // Help and version come this way too, with code 0.
    std::ostringstream shown, problem;
    const int code = app_->exit(error, shown, problem);
    fmt::print("{}", shown.str());
    tell_text(problem.str().empty() ? "" : "abbe: " + problem.str());
    return code == 0 ? ParseResult::shown : ParseResult::refused;
  }
  for (const std::unique_ptr<Subcommand>& subcommand : subcommands_) {
    if (subcommand->parsed()) subcommand->check_outputs();
  }
  return ParseResult::command;
}

}  // namespace abbe
