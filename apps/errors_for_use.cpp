#include "errors_for_use.h"

#include "abbe/formats/machine/state_option.h"
#include "messages.h"
#include "options.h"

namespace abbe {

ErrorsFile read_errors_for_use(const std::filesystem::path& path, const Machine& machine, bool accept_misfit,
                               const std::vector<std::string>& states, StatesOfErrors not_given) {
  ErrorsFile contents = read_errors_at(path, machine, states, not_given);
  require_trusted(contents, path.string(), accept_misfit);
  for (const std::string& reason : contents.distrusted)
    tell("abbe: {}: used although marked as not to be trusted: {}\n", path.string(), reason);
  return contents;
}

void tell_distrusted(const std::filesystem::path& path, const ErrorsFile& contents) {
  for (const std::string& reason : contents.distrusted)
    tell("abbe: {}: marked as not to be trusted: {}\n", path.string(), reason);
}

ErrorsFile read_errors_and_tell(const std::filesystem::path& path, const Machine& machine, StatesOfErrors states) {
  ErrorsFile contents = read_errors(path, machine, states);
  tell_distrusted(path, contents);
  return contents;
}

ErrorsFile read_errors_and_tell(const std::filesystem::path& path, const Machine& machine,
                                const std::vector<std::string>& states) {
  ErrorsFile contents = read_errors_at(path, machine, states);
  tell_distrusted(path, contents);
  return contents;
}

void add_states(Subcommand& command, std::vector<std::string>& states) {
  command
      .add_option("--state", states,
                  "NAME_unit=value, such as ambient_degC=26.5: use the errors at this value of a measured or lag "
                  "state; repeatable")
      ->allow_extra_args(false);
}

void add_workpiece(Subcommand& command, WorkpieceOptions& workpiece) {
  for (const auto& one : workpiece_numbers()) command.add_option(one.option, workpiece.*one.value, one.words);
  command.add_option("--workpiece-state", workpiece.state, "State of the machine file that is its temperature, degC");
  const char* const fixed =
      "Point of the workpiece that does not move as it expands, mm, workpiece frame (default 0 0 0)";
  command.add_option("--workpiece-fixed-mm", workpiece.fixed_mm, fixed)->expected(3);
}

void add_accept_misfit(Subcommand& command, bool& accept_misfit) {
  command.add_flag("--accept-misfit", accept_misfit, "Use errors that are marked as not to be trusted");
}

}  // namespace abbe
