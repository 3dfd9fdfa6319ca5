// Options that name files: what is read and what is written.
#include <algorithm>
#include <filesystem>
#include <system_error>

#include "abbe/formats/files/existing_output.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/files/standard_input.h"
#include "abbe/formats/text/input_error.h"
#include "messages.h"
#include "options.h"

namespace abbe {

Option* Subcommand::add_input_file(const std::string& name, std::string& value, const std::string& description) {
  Option* const option = add_option(name, value, description);
  inputs_.push_back({option, [&value] { return std::vector<std::string*>{&value}; }});
  return option;
}

Option* Subcommand::add_input_file(const std::string& name, std::vector<std::string>& value,
                                   const std::string& description) {
  Option* const option = add_option(name, value, description);
  inputs_.push_back({option, [&value] {
                       std::vector<std::string*> names;
                       for (std::string& one : value) names.push_back(&one);
                       return names;
                     }});
  return option;
}

void tell_old_form(const std::string& written) {
  tell("abbe: warning: this is an old form of the command; write {}\n", written);
}

void Subcommand::take_inputs(std::vector<std::string>& options) {
  if (!old_form_.empty()) tell_old_form(old_form_);
  for (const Input& input : inputs_) {
    for (std::string* const name : input.names()) {
      if (*name != "-") continue;
      *name = kStandardInput;
      options.push_back(input.option->get_name());
    }
  }
  for (const std::unique_ptr<Subcommand>& subcommand : subcommands_) {
    if (subcommand->parsed()) subcommand->take_inputs(options);
  }
}

void Subcommand::add_force() {
  if (has_force_) return;
  has_force_ = true;
  add_flag("--force", force_, "Replace existing files");
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

}  // namespace abbe
