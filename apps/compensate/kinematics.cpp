#include <fmt/format.h>

#include <cstddef>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/controls/kinematic_values.h"
#include "abbe/controls/kinematic_values_text.h"
#include "abbe/formats/files/kept_inputs.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/axis_option.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "command.h"
#include "compensate/compensate.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "machine_options.h"
#include "messages.h"
#include "options.h"
#include "uncovered_poses.h"

namespace abbe {
namespace {

struct KinematicsArguments {
  std::string machine, errors, format, output;
  std::vector<std::string> states, at;
  std::optional<double> limit_um, limit_urad;
  std::optional<std::size_t> positions;
  std::optional<int> tool_carrier;
  double least_reduction_percent = 1;
  bool json = false, dry_run = false, accept_misfit = false;
};

int run_kinematics(const KinematicsArguments& arguments) {
  KinematicValuesRequest request;
  request.format = arguments.format;
  request.machine = read_machine(arguments.machine);
  const ErrorsFile file =
      read_errors_for_use(arguments.errors, request.machine, arguments.accept_misfit, arguments.states);
  request.errors = file.errors;
  request.covariance = file.covariance;
  if (arguments.output.empty() && !arguments.dry_run) {
    throw InputError({.field = "-o"}, "no output", "a file, or --dry-run");
  }
  if (!arguments.output.empty()) refuse_input_as_output(arguments.output);
  if (arguments.limit_um) request.limit_mm = 1e-3 * *arguments.limit_um;
  if (arguments.limit_urad) request.limit_rad = 1e-6 * *arguments.limit_urad;
  request.positions = arguments.positions;
  request.at = axis_options(request.machine, "--at", arguments.at);
  request.tool_carrier = arguments.tool_carrier;
  request.least_reduction = 0.01 * arguments.least_reduction_percent;

  const KinematicValues made = make_kinematic_values(request);
  std::vector<std::string> written;
  if (!made.says_no() && !arguments.dry_run) {
    write_file_atomically(arguments.output, made.file.text);
    written.push_back(arguments.output);
  }
  const KinematicValuesReport report{request.machine, made, partial_errors(request.machine, file), written};
  fmt::print("{}", arguments.json ? json_text(kinematic_values_json(report)) : kinematic_values_text(report));
  if (arguments.dry_run && !arguments.json) fmt::print("dry run: nothing is written\n");
  std::fflush(stdout);
  for (const std::string& words : made.refused) tell("abbe: {}; nothing is written\n", words);
  return tell_outside(file.at_state, made.says_no() ? kNegative : kDone);
}

}  // namespace

void add_compensate_kinematics(Subcommand& compensate, CommandLine& line) {
  auto arguments = std::make_shared<KinematicsArguments>();
  std::string formats = "Formats:\n";
  std::vector<std::string> names;
  for (const KinematicFormatWords& format : kinematic_formats()) {
    names.push_back(format.name);
    formats += fmt::format("  {:<10} {}\n", format.name, format.what);
    if (!format.unverified.empty()) {
      formats += fmt::format("  {:<10} EXPERIMENTAL, not verified: {}\n", "", format.unverified);
    }
  }
  Subcommand* const command =
      compensate.add_subcommand("kinematics", "Write the positions and directions of rotary axes for a control");
  command->footer(formats +
                  "\nExample:\n"
                  "  abbe compensate kinematics --machine examples/machines/trunnion-mill.machine.toml --errors "
                  "examples/compensate/trunnion.errors.toml --for siemens -o TRAFO5.INI\n"
                  "Frames, signs and sources of every format: docs/kinematic-values.md");
  add_machine_and_errors(*command, arguments->machine, arguments->errors);
  command->add_option("--for", arguments->format, "Format, see below")->required()->suggest(names);
  command->add_output_file("-o,--output", arguments->output, "File to write", &arguments->dry_run);
  command->add_flag("--dry-run", arguments->dry_run, "Report only; write nothing");
  command->add_option("--tool-carrier", arguments->tool_carrier,
                      "siemens: write $TC_CARR of the tool carrier with this number instead of machine data");
  command->add_option("--positions", arguments->positions,
                      "Positions per axis at which the displacement is stated (default 9; 5 with more than 3 axes)");
  command->add_option("--limit-um", arguments->limit_um, "Refuse values if a length changes by more than this, um");
  command->add_option("--limit-urad", arguments->limit_urad,
                      "Refuse values if a direction or an angle changes by more than this, urad");
  command
      ->add_option("--least-reduction-percent", arguments->least_reduction_percent,
                   "Refuse values that remove less of the displacement than this; 0 writes them anyway")
      ->check(in_range(0.0, 100.0))
      ->capture_default_str();
  add_states(*command, arguments->states);
  command->add_option("--at", arguments->at,
                      "Position of an axis for states that follow from the commands, AXIS_unit=position; repeatable "
                      "(default: middle of its travel)");
  add_accept_misfit(*command, arguments->accept_misfit);
  command->add_flag("--json", arguments->json, "Print JSON for programs");
  command->callback([arguments, &line] { line.run = [arguments] { return run_kinematics(*arguments); }; });
}

}  // namespace abbe
