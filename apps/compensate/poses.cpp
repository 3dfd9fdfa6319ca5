#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/files/kept_inputs.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/axis_option.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/machine/workpiece_option.h"
#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/study/compensation/corrected_commands.h"
#include "abbe/study/compensation/corrected_robot_program.h"
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

struct PosesCommand {
  std::string machine, errors, poses, output;
  std::vector<std::string> hold, states;
  std::optional<double> limit_um;
  std::optional<double> largest_turn_deg;
  double leave_out_factor = 0;
  WorkpieceOptions workpiece;
  bool dry_run = false, json = false, accept_misfit = false;
};

int run_robot_program(const PosesCommand& command, RobotLanguage language) {
  RobotProgramRequest request;
  request.machine_file = command.machine;
  request.machine = read_machine(command.machine);
  request.errors = read_errors_for_use(command.errors, request.machine, command.accept_misfit, command.states,
                                       StatesOfErrors::allowed);
  if (command.workpiece.any()) {
    throw InputError({.field = "--workpiece-..."}, "a robot program is not corrected for the workpiece's expansion",
                     "poses in a CSV file");
  }
  request.program = parse_robot_program(read_text_file(command.poses), language, command.poses);
  if (!command.output.empty()) refuse_input_as_output(command.output);
  request.leave_out_factor = command.leave_out_factor;
  request.limit_um = command.limit_um;
  if (command.largest_turn_deg) request.largest_turn = *command.largest_turn_deg * kDegree;
  request.held = axes_named(request.machine, "--hold", command.hold);
  const CorrectedRobotProgram result = correct_robot_program(request);
  const bool written = result.refused.empty() && !command.dry_run;
  if (written) write_file_atomically(command.output, result.text);
  fmt::print("{}", command.json ? json_text(corrected_robot_json(request, result, command.output, written))
                                : corrected_robot_text(request, result, command.output, written));
  std::fflush(stdout);
  if (!result.refused.empty()) tell("abbe: {}; nothing written\n", result.refused);
  return tell_outside(request.errors.at_state, result.refused.empty() ? kDone : kNegative);
}

int run_poses(const PosesCommand& command) {
  if (command.output.empty() && !command.dry_run)
    throw InputError({.field = "-o"}, "missing", "a file for the corrected commands (*.csv), or --dry-run");
  if (const auto language = robot_language_of(command.poses)) return run_robot_program(command, *language);
  CommandsRequest request;
  request.machine_file = command.machine;
  request.errors_file = command.errors;
  request.machine = read_machine(command.machine);
  request.errors = read_errors_for_use(command.errors, request.machine, command.accept_misfit, command.states,
                                       StatesOfErrors::allowed);
  request.poses = read_poses(command.poses, request.machine);
  request.workpiece = workpiece_option(request.machine, command.workpiece, command.states, request.poses);
  if (!command.output.empty()) refuse_input_as_output(command.output);
  request.leave_out_factor = command.leave_out_factor;
  request.limit_um = command.limit_um;
  if (command.largest_turn_deg) request.largest_turn = *command.largest_turn_deg * kDegree;
  request.held = axes_named(request.machine, "--hold", command.hold);
  const CorrectedCommands result = correct_commands(request);
  const bool written = result.refused.empty() && !command.dry_run;
  if (written) write_file_atomically(command.output, corrected_commands_csv(result));
  if (command.json) {
    fmt::print("{}", json_text(corrected_commands_json(result, command.output, written)));
  } else {
    fmt::print("{}", corrected_commands_text(result));
    fmt::print("{}", written ? command.output + " written\n" : command.dry_run ? "dry run: nothing written\n" : "");
  }
  std::fflush(stdout);
  if (!result.refused.empty()) {
    tell("abbe: {}; nothing written\n", result.refused);
    return kNegative;
  }
  if (result.not_reached > 0) {
    tell("abbe: the tool does not reach {} of {} poses; the column status says where and why\n", result.not_reached,
         result.poses.count());
  }
  return tell_outside(result.at_state, result.not_reached == 0 ? kDone : kNegative);
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
      "A robot program (*.mod, *.src, *.dat, *.ls, *.script) is written again with corrected positions.\n"
      "See docs/compensation.md and docs/robot-programs.md.");
  command->add_input_file("poses", options->poses, "CSV with a column of commands per axis, or a robot program")
      ->required();
  add_machine_and_errors(*command, options->machine, options->errors);
  command->add_output_file("-o,--output", options->output,
                           "CSV (commands, status, remaining errors) or program to write", &options->dry_run);
  command->add_option("--hold", options->hold, "Axis that keeps its commands; repeatable");
  command->add_option("--largest-turn-deg", options->largest_turn_deg,
                      "How far rotary axes may turn for a correction (default 0.5; arms: 5)");
  command->add_option("--limit-um", options->limit_um, "Refuse corrections of the functional point above this, um");
  command->add_option("--leave-out-below-uncertainty", options->leave_out_factor,
                      "Leave out errors that are everywhere smaller than this many times their standard uncertainties");
  add_workpiece(*command, options->workpiece);
  command->add_flag("--dry-run", options->dry_run,
                    "Report only: the largest corrections and where they are; write nothing");
  add_states(*command, options->states);
  add_accept_misfit(*command, options->accept_misfit);
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options] { line.run = [options] { return run_poses(*options); }; });
}

}  // namespace abbe
