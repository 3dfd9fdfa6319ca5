#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "abbe/formats/files/kept_inputs.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/report/words/corrected_poses_words.h"
#include "command.h"
#include "compensate/compensate.h"
#include "compensate/safety.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "machine_options.h"
#include "messages.h"
#include "options.h"

namespace abbe {
namespace {

struct PosesCommand {
  std::string machine, errors, poses, output;
  std::vector<std::string> hold;
  std::optional<double> limit_um;
  double largest_turn_deg = 0.5, leave_out_factor = 0;
  bool dry_run = false, json = false, accept_misfit = false;
};

std::vector<std::size_t> held_axes(const PosesCommand& command, const Machine& machine) {
  std::vector<std::size_t> held;
  for (const std::string& name : command.hold) {
    const std::size_t axis = machine.find_axis(name);
    if (axis == Machine::npos) {
      throw InputError({.field = "--hold " + name}, "the machine has no such axis", machine.chain());
    }
    held.push_back(axis);
  }
  return held;
}

int run_poses(const PosesCommand& command) {
  if (command.output.empty() && !command.dry_run)
    throw InputError({.field = "-o"}, "missing", "a file for the corrected commands (*.csv), or --dry-run");
  const Machine machine = read_machine(command.machine);
  const ErrorsFile errors = read_errors_for_use(command.errors, machine, command.accept_misfit);
  const PoseList poses = read_poses(command.poses, machine);
  if (!command.output.empty()) refuse_input_as_output(command.output);
  check_leave_out(command.leave_out_factor, errors, command.errors);
  const double limit_um = refusal_limit("--limit-um", command.limit_um, "um");

  const CorrectedPoses result = corrected_poses(machine, errors.errors, errors.covariance, poses,
                                                {.largest_turn = largest_turn_option(command.largest_turn_deg),
                                                 .leave_out_factor = command.leave_out_factor,
                                                 .held = held_axes(command, machine)});
  if (!result.problem.empty()) throw InputError({.file = command.machine}, result.problem);
  const bool refused = !(1e3 * result.largest_shift.value <= limit_um);
  const bool written = !refused && !command.dry_run;
  if (written) write_file_atomically(command.output, poses_csv(machine, result));
  if (command.json) {
    fmt::print("{}", json_text(poses_json(machine, poses, result, command.output, written)));
  } else {
    fmt::print("{}", poses_text(machine, poses, result, command.leave_out_factor));
    if (!errors.errors.reversals.empty())
      fmt::print("reversal values are not in these commands: a pose has no direction of approach\n");
    fmt::print("{}", written ? command.output + " written\n" : command.dry_run ? "dry run: nothing written\n" : "");
  }
  std::fflush(stdout);
  if (refused) {
    tell("abbe: correction of {:.3f} um above --limit-um {:g}: {}; nothing written\n", 1e3 * result.largest_shift.value,
         limit_um, pose_words(machine, poses, result.largest_shift.row));
    return kNegative;
  }
  const auto wrong = std::count_if(result.status.begin(), result.status.end(),
                                   [](CorrectionStatus status) { return !reaches_point(status); });
  if (wrong > 0) {
    tell("abbe: the tool is not brought to {} of {} poses; the column status says where and why\n", wrong,
         poses.count());
  }
  return wrong > 0 ? kNegative : kDone;
}

}  // namespace

void add_compensate_poses(Subcommand& compensate, CommandLine& line) {
  auto options = std::make_shared<PosesCommand>();
  Subcommand* const command = compensate.add_subcommand(
      "poses", "Correct single poses: axis commands that bring the actual tool to where the nominal machine has it");
  command->footer(
      "Example:\n"
      "  abbe compensate poses examples/compensate/poses.csv --machine "
      "examples/machines/trunnion-mill.machine.toml --errors examples/compensate/trunnion.errors.toml -o "
      "corrected.csv\n\n"
      "Every row of the output has a status: reached; orientation left or turn limited (the point is exact, and the\n"
      "remaining orientation error is stated); position left, outside travel, not covered or not converged (exit code "
      "1).\n"
      "See docs/compensation.md.");
  command->add_input_file("poses", options->poses, "CSV with one column of commands per axis (X_mm, C_deg, ...)")
      ->required();
  add_machine_and_errors(*command, options->machine, options->errors);
  command->add_output_file("-o,--output", options->output, "CSV to write: corrected commands, status, what is left",
                           &options->dry_run);
  command->add_option("--hold", options->hold, "Axis that keeps its commands; repeatable");
  command
      ->add_option("--largest-turn-deg", options->largest_turn_deg,
                   "How far rotary axes may turn for a correction near a singularity")
      ->capture_default_str();
  command->add_option("--limit-um", options->limit_um, "Refuse corrections of the functional point above this, um");
  command->add_option("--leave-out-below-uncertainty", options->leave_out_factor,
                      "Leave out errors that are everywhere smaller than this many of their standard uncertainties");
  command->add_flag("--dry-run", options->dry_run,
                    "Report only: the largest corrections and where they are; write nothing");
  add_accept_misfit(*command, options->accept_misfit);
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options] { line.run = [options] { return run_poses(*options); }; });
}

}  // namespace abbe
