#include "options.h"

#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <sstream>
#include <type_traits>
#include <utility>

#include "abbe/formats/files/standard_input.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/nearest_word.h"
#include "abbe/formats/text/wrapped_text.h"
#include "messages.h"

namespace abbe {
namespace {

constexpr double kLargest = std::numeric_limits<double>::max();

/// `words` follow "number": "from 0 to 9".
template <typename Number>
Check number_check(Number from, Number to, const std::string& words) {
  const auto problem = [=](const std::string& text) -> std::string {
    Number value{};
    if (CLI::detail::lexical_cast(text, value) && value >= from && value <= to) return {};
    return fmt::format("'{}' is not a {}number {}", text, std::is_integral_v<Number> ? "whole " : "", words);
  };
  return {problem, words};
}

constexpr const char* kQuietWords = "No progress and no text; --json and files on standard output are still written";

}  // namespace

Check in_range(int from, int to) { return number_check(from, to, fmt::format("from {} to {}", from, to)); }
Check in_range(double from, double to) { return number_check(from, to, fmt::format("from {} to {}", from, to)); }
Check positive_number() { return number_check(std::numeric_limits<double>::denorm_min(), kLargest, "above 0"); }
Check non_negative_number() { return number_check(0.0, kLargest, "of at least 0"); }
Check one_of(const std::vector<std::string>& words) {
  const CLI::Validator member = CLI::IsMember(words);
  return {[member](const std::string& text) { return member(text); }, member.get_description(), words};
}

Option* Option::required() {
  option_->required();
  return this;
}

Option* Option::check(const Check& check) {
  const bool is_list = !check.words.empty();
  option_->check(CLI::Validator([problem = check.problem](std::string& text) { return problem(text); },
                                is_list ? check.description : ""));
  if (is_list)
    words_ = check.words;
  else
    option_->type_name(option_->get_type_name() + " " + check.description);
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

Subcommand::Subcommand(CLI::App& app) : app_(&app) { add_flag("-q,--quiet", quiet_, kQuietWords); }

Option* Subcommand::own(CLI::Option& option) { return options_.emplace_back(std::make_unique<Option>(option)).get(); }

template <typename Value>
Option* Subcommand::add_option(const std::string& name, Value& value, const std::string& description) {
  return own(*app_->add_option(name, value, description));
}

template Option* Subcommand::add_option(const std::string&, std::string&, const std::string&);
template Option* Subcommand::add_option(const std::string&, double&, const std::string&);
template Option* Subcommand::add_option(const std::string&, int&, const std::string&);
// Two of these are std::size_t and std::uint64_t, which of them depends on the system.
template Option* Subcommand::add_option(const std::string&, unsigned&, const std::string&);
template Option* Subcommand::add_option(const std::string&, unsigned long&, const std::string&);
template Option* Subcommand::add_option(const std::string&, unsigned long long&, const std::string&);
template Option* Subcommand::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option* Subcommand::add_option(const std::string&, std::optional<int>&, const std::string&);
template Option* Subcommand::add_option(const std::string&, std::optional<std::size_t>&, const std::string&);
template Option* Subcommand::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Option* Subcommand::add_option(const std::string&, std::vector<double>&, const std::string&);
template Option* Subcommand::add_option(const std::string&, std::vector<std::vector<double>>&, const std::string&);

Option* Subcommand::add_option_function(const std::string& name,
                                        const std::function<void(const std::string& text)>& take,
                                        const std::string& description) {
  return own(*app_->add_option_function<std::string>(name, take, description));
}

Option* Subcommand::add_flag(const std::string& name, bool& value, const std::string& description) {
  return own(*app_->add_flag(name, value, description));
}

void Subcommand::take_from_arguments(const std::vector<Option*>& options) {
  std::vector<CLI::Option*> all;  // in the order in which the old form has them
  for (const Option* const option : options) all.push_back(option->option_);
  for (CLI::Option* const option : app_->get_options()) {
    if (option->get_positional()) all.push_back(option);
  }
  // In a group without a name, so that no help shows it. It gets the words that are left over.
  CLI::App* const group = app_->add_option_group("");
  group->add_option_function<std::vector<std::string>>("arguments", [=, this](std::vector<std::string> rest) {
    if (rest.size() != options.size()) return;  // unexpected_words() names them
    std::vector<std::string> words;
    for (CLI::Option* const option : app_->get_options()) {
      if (!option->get_positional()) continue;
      words.insert(words.end(), option->results().begin(), option->results().end());
      option->clear();
    }
    words.insert(words.end(), rest.begin(), rest.end());
    for (std::size_t k = 0; k < std::min(all.size(), words.size()); ++k) {
      if (k < options.size()) old_form_ += fmt::format("{}{} {}", k > 0 ? " " : "", all[k]->get_name(), words[k]);
      all[k]->add_result(words[k])->run_callback();
    }
    group->get_option("arguments")->clear();
  });
}

bool Subcommand::has_flag(const std::string& name) const {
  const CLI::Option* const flag = app_->get_option_no_throw(name);
  if (flag != nullptr && flag->count() > 0) return true;
  return std::any_of(subcommands_.begin(), subcommands_.end(),
                     [&](const auto& one) { return one->parsed() && one->has_flag(name); });
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
    : app_(std::make_unique<CLI::App>(description, name)) {
  app_->add_flag("-q,--quiet", quiet_, kQuietWords);
}
Program::~Program() = default;

Subcommand* Program::add_subcommand(const std::string& name, const std::string& description) {
  return subcommands_.emplace_back(std::make_unique<Subcommand>(*app_->add_subcommand(name, description))).get();
}

namespace {

std::vector<std::string> subcommand_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* const one : app.get_subcommands([](const CLI::App* sub) { return !sub->get_name().empty(); })) {
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

/// Words that cannot be placed, also those that are not as many as an old form has (Subcommand::take_from_arguments()).
std::vector<std::string> extra_words(const CLI::App& program) {
  std::vector<std::string> words = program.remaining(true);
  for (const CLI::App* const group :
       innermost_command(program).get_subcommands([](const CLI::App* sub) { return sub->get_name().empty(); })) {
    const std::vector<std::string>& more = group->get_option("arguments")->results();
    words.insert(words.end(), more.begin(), more.end());
  }
  return words;
}

/// What cannot be placed, and what may have been meant.
std::string unexpected_words(const CLI::App& program, const std::vector<std::string>& extras) {
  const CLI::App& command = innermost_command(program);
  std::string text;
  for (const std::string& word : extras) {
    const bool is_option = word.starts_with('-') && word.size() > 1;
    const std::string name = is_option ? word.substr(0, word.find('=')) : word;
    const std::optional<std::string> meant =
        nearest_word(name, is_option ? option_names(command) : subcommand_names(command));
    const bool is_misplaced = meant == name;
    text += fmt::format("abbe: '{}' is {} {}{}\n", name,
                        is_misplaced ? "expected behind"
                        : is_option  ? "not an option of"
                                     : "not expected by",
                        words_of(command), meant && !is_misplaced ? "; did you mean " + *meant + "?" : "");
  }
  return text + fmt::format("abbe: {} --help lists what there is\n", words_of(command));
}

/// What is done before a command runs, whatever it does.
void begin(Subcommand& command, bool quiet) {
  std::vector<std::string> from_standard_input;
  command.take_inputs(from_standard_input);
  if (from_standard_input.size() > 1) {
    throw InputError({.field = fmt::format("{}", fmt::join(from_standard_input, ", "))},
                     "more than one file is standard input", "- for one of them at most");
  }
  if (!from_standard_input.empty()) accept_standard_input();
  command.check_outputs();
  if (quiet || command.has_flag("--quiet")) be_quiet(!command.has_flag("--json"));
}

}  // namespace

ParseResult Program::parse(int argc, const char* const* argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // What is missing is often there, but misspelled.
    const std::vector<std::string> extras = extra_words(*app_);
    const bool is_lack = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
    if ((is_lack || dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) && !extras.empty()) {
      tell_text(unexpected_words(*app_, extras));
      return ParseResult::refused;
    }
    // Help and version come this way too, with code 0.
    std::ostringstream shown, problem;
    const int code = app_->exit(error, shown, problem);
    fmt::print("{}", wrapped_help(shown.str(), 120, "abbe "));
    tell_text(prefixed_lines("abbe: ", problem.str()));
    return code == 0 ? ParseResult::shown : ParseResult::refused;
  }
  if (const std::vector<std::string> extras = extra_words(*app_); !extras.empty()) {
    tell_text(unexpected_words(*app_, extras));
    return ParseResult::refused;
  }
  for (const std::unique_ptr<Subcommand>& subcommand : subcommands_) {
    if (subcommand->parsed()) begin(*subcommand, quiet_);
  }
  return ParseResult::command;
}

}  // namespace abbe
