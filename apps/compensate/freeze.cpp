#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/files/kept_inputs.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/study/compensation/frozen_errors.h"
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

struct FreezeArguments {
  std::string machine, errors, output, world = "joints";
  std::vector<std::string> states;
  std::vector<double> tool, lengths{0, 300};
  std::vector<std::string> state_ranges;
  std::optional<double> limit_um;
  double largest_turn_deg = 0.57;
  double leave_out_factor = 0;
  bool json = false, dry_run = false, accept_misfit = false;
};

int run_freeze(const FreezeArguments& arguments) {
  FreezeRequest request;
  request.machine = read_machine(arguments.machine);
  request.errors = read_errors_for_use(arguments.errors, request.machine, arguments.accept_misfit, arguments.states,
                                       StatesOfErrors::allowed);
  request.errors_file = arguments.errors;
  if (arguments.output.empty() && !arguments.dry_run) {
    throw InputError({.field = "-o"}, "missing", "a file for the frozen compensation (*.abbec), or --dry-run");
  }
  if (!arguments.output.empty()) refuse_input_as_output(arguments.output);
  if (!arguments.tool.empty()) request.tool = {arguments.tool[0], arguments.tool[1], arguments.tool[2]};
  request.tool_length_min = arguments.lengths[0];
  request.tool_length_max = arguments.lengths[1];
  request.largest_turn = arguments.largest_turn_deg * kDegree;
  request.world_zero_at_joints = arguments.world == "joints";
  request.leave_out_factor = arguments.leave_out_factor;
  request.limit_um = arguments.limit_um;
  request.state_ranges = arguments.state_ranges;
  const FrozenErrors result = freeze_errors(request);
  const bool written = result.refused.empty() && !arguments.dry_run;
  if (written) write_file_atomically(arguments.output, result.bytes());
  const FrozenOutput file{.file = arguments.output, .written = written, .dry_run = arguments.dry_run};
  fmt::print("{}", arguments.json ? json_text(frozen_errors_json(result, file)) : frozen_errors_text(result, file));
  if (!result.refused.empty()) tell("abbe: refused: {}; nothing was written\n", result.refused);
  return tell_outside(result.at_state, result.refused.empty() ? kDone : kNegative);
}

}  // namespace

void add_compensate_freeze(Subcommand& compensate, CommandLine& line) {
  auto arguments = std::make_shared<FreezeArguments>();
  Subcommand* command = compensate.add_subcommand(
      "freeze", "Write the machine and its errors to one file that a controller uses in real time");
  command->footer(
      "The file is for the C interface abbe/runtime/abbe_runtime.h and for the LinuxCNC module (docs/runtime.md). It\n"
      "is tested at thousands of poses before it is written; the printed figures come from these tests. It does not\n"
      "contain reversal values: the lines for LinuxCNC's own BACKLASH are printed instead. Errors that depend on\n"
      "states (temperatures, loads) are compensated with values that the controller gives in every cycle.\n\n"
      "Example:\n"
      "  abbe compensate freeze --machine examples/machines/trunnion-mill.machine.toml --errors "
      "examples/trunnion/table.errors.toml -o mill.abbec\n"
      "  abbe compensate freeze --machine examples/machines/trunnion-mill.machine.toml --errors "
      "examples/trunnion/table.errors.toml -o long-tools.abbec --tool-length-mm 60 220 --limit-um 500");
  add_machine_and_errors(*command, arguments->machine, arguments->errors);
  command->add_output_file("-o,--output", arguments->output, "File to write (*.abbec)", &arguments->dry_run);
  command->add_flag("--dry-run", arguments->dry_run,
                    "Report only: the largest corrections and where they are; write nothing");
  command
      ->add_option("--tool-mm", arguments->tool,
                   "Functional point from the gauge point, for calls that give no tool (default: that of the machine)")
      ->expected(3);
  command->add_option("--tool-length-mm", arguments->lengths, "Tool lengths that are tested; others are flagged")
      ->expected(2)
      ->capture_default_str();
  command->add_option("--state-range", arguments->state_ranges,
                      "NAME_unit=FROM:TO, such as ambient_degC=15:30: values of a measured state that are compensated; "
                      "beyond them, the limit is held and then the reference is used (default: what the readings "
                      "covered; temperatures without that: 5 K below to 10 K above the reference)");
  command->add_option("--limit-um", arguments->limit_um, "Refuse if the tool would be corrected by more than this");
  command
      ->add_option("--largest-turn-deg", arguments->largest_turn_deg,
                   "Largest turn of all rotary axes together; takes effect near singularities")
      ->capture_default_str();
  command
      ->add_option("--world", arguments->world,
                   "Origin of world coordinates: joints (zero where all joints are) or workpiece")
      ->check(one_of({"joints", "workpiece"}))
      ->capture_default_str();
  command->add_option("--leave-out-below-uncertainty", arguments->leave_out_factor,
                      "Leave out errors that are everywhere smaller than this many times their standard uncertainties");
  add_states(*command, arguments->states);
  add_accept_misfit(*command, arguments->accept_misfit);
  command->add_flag("--json", arguments->json, "Print JSON for programs");
  command->callback([arguments, &line] { line.run = [arguments] { return run_freeze(*arguments); }; });
}

}  // namespace abbe
