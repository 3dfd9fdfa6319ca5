#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "abbe/compensate/compensated_inverse.h"
#include "abbe/compensate/left_out_errors.h"
#include "abbe/compensate/program_uncertainty.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/formats/errors_file.h"
#include "abbe/formats/input_error.h"
#include "abbe/formats/json_text.h"
#include "abbe/formats/kept_inputs.h"
#include "abbe/formats/machine_file.h"
#include "abbe/formats/measurement_file.h"
#include "abbe/formats/number_text.h"
#include "abbe/formats/results_folder.h"
#include "abbe/geometry/angle.h"
#include "abbe/machine/axis_unit.h"
#include "command.h"
#include "compensate/compensate.h"
#include "compensate/position_words.h"
#include "compensate/safety.h"
#include "errors_for_use.h"
#include "exit_code.h"
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

/// A figure and the row of the file where it is, from 1; 0: nowhere.
struct Largest {
  double value = 0;
  std::size_t row = 0;
  void take(double other, std::size_t at) {
    if (!(std::abs(other) > value)) return;
    value = std::abs(other);
    row = at;
  }
};

struct CorrectedPoses {
  PoseList commands;
  std::vector<CorrectionStatus> status;
  std::vector<double> position_left, orientation_left;  // mm, rad; NaN where not known
  std::vector<double> shift, uncertainty;               // mm, of the functional point; NaN and empty likewise
  std::array<std::size_t, kCorrectionStatuses> count{}, first_row{};
  Largest largest_shift, largest_position_left, largest_orientation_left;
  std::vector<Largest> by_axis;
  LeftOutErrors left_out;
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

void state_statistics(const Machine& machine, const PoseList& poses, CorrectedPoses& result) {
  result.by_axis.resize(machine.axes.size());
  for (std::size_t k = 0; k < poses.count(); ++k) {
    const auto status = static_cast<std::size_t>(result.status[k]);
    if (result.count[status]++ == 0) result.first_row[status] = k + 1;
    result.largest_shift.take(result.shift[k], k + 1);
    result.largest_position_left.take(result.position_left[k], k + 1);
    result.largest_orientation_left.take(result.orientation_left[k], k + 1);
    for (std::size_t i = 0; i < machine.axes.size(); ++i)
      result.by_axis[i].take(result.commands.axis[i][k] - poses.axis[i][k], k + 1);
  }
}

/// What stays of all errors, those included that were left out.
void state_left_by_all(const Machine& machine, const ErrorSet& errors, const PoseList& poses, CorrectedPoses& result) {
  for (std::size_t k = 0; k < poses.count(); ++k) {
    if (!std::isfinite(result.position_left[k])) continue;
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, poses.pose(k));
    const RigidTransform actual = actual_workpiece_from_tool(machine, errors, result.commands.pose(k));
    result.position_left[k] = (actual.translation - wanted.translation).norm();
    result.orientation_left[k] =
        angle_between(actual.rotation * machine.tool_direction, wanted.rotation * machine.tool_direction);
  }
}

CorrectedPoses corrected_poses(const PosesCommand& command, const Machine& machine, const ErrorsFile& errors,
                               const PoseList& poses) {
  CorrectedPoses result;
  const Eigen::MatrixXd covariance = parameter_covariance(errors.errors, errors.covariance);
  ErrorSet corrected = errors.errors;
  if (command.leave_out_factor > 0)
    result.left_out = leave_out_uncertain(machine, corrected, covariance, command.leave_out_factor);
  CorrectionOptions options;
  options.largest_turn = largest_turn_option(command.largest_turn_deg);
  const CompensatedInverse inverse(machine, corrected, options, held_axes(command, machine));
  if (!inverse.problem().empty()) throw InputError({.file = command.machine}, inverse.problem());

  const std::size_t count = poses.count();
  result.commands = poses;
  result.status.resize(count);
  result.position_left.resize(count);
  result.orientation_left.resize(count);
  std::vector<const double*> in;
  std::vector<double*> out;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    in.push_back(poses.axis[i].data());
    out.push_back(result.commands.axis[i].data());
  }
  inverse.correct({in, count},
                  {out, result.status.data(), result.position_left.data(), result.orientation_left.data()});

  if (!result.left_out.names.empty()) state_left_by_all(machine, errors.errors, poses, result);
  const bool stated = !covariance.isZero(0);
  const std::vector<bool> moved(machine.axes.size(), true);
  for (std::size_t k = 0; k < count; ++k) {
    Deviation deviation;
    const bool known = tool_deviation(machine, corrected, poses.pose(k), deviation) == PoseStatus::ok;
    result.shift.push_back(known ? deviation.head<3>().norm() : std::nan(""));
    if (!stated) continue;
    ProgramPlace place;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) place.position[i] = poses.axis[i][k];
    result.uncertainty.push_back(known ? uncertainty_at(machine, errors.errors, covariance, place, moved).point
                                       : std::nan(""));
  }
  state_statistics(machine, poses, result);
  return result;
}

std::string poses_csv(const Machine& machine, const CorrectedPoses& result) {
  std::string text;
  for (const Axis& axis : machine.axes) text += axis.name + "_" + position_suffix(axis) + ",";
  text += "status,correction_um,";
  if (!result.uncertainty.empty()) text += "u_correction_um,";
  text += "position_left_um,orientation_left_urad\n";
  // What is not known is an empty field.
  const auto number = [](double value) { return std::isfinite(value) ? shortest_text(value) : std::string(); };
  for (std::size_t k = 0; k < result.status.size(); ++k) {
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      text += number(result.commands.axis[i][k] / position_unit(machine.axes[i])) + ",";
    }
    text += fmt::format("{},{},", correction_status_text(result.status[k]), number(1e3 * result.shift[k]));
    if (!result.uncertainty.empty()) text += number(1e3 * result.uncertainty[k]) + ",";
    text += number(1e3 * result.position_left[k]) + "," + number(1e6 * result.orientation_left[k]) + "\n";
  }
  return text;
}

std::string pose_words(const Machine& machine, const PoseList& poses, std::size_t row) {
  return fmt::format("row {}, {}", row, position_words(machine, poses.pose(row - 1)));
}

void print_poses(const PosesCommand& command, const Machine& machine, const PoseList& poses,
                 const CorrectedPoses& result) {
  fmt::print("{} poses of {}\n", poses.count(), machine.name);
  for (std::size_t s = 0; s < kCorrectionStatuses; ++s) {
    if (result.count[s] == 0) continue;
    fmt::print("  {}: {}{}\n", correction_status_text(static_cast<CorrectionStatus>(s)), result.count[s],
               s == static_cast<std::size_t>(CorrectionStatus::reached)
                   ? ""
                   : fmt::format(", first in row {}", result.first_row[s]));
  }
  if (result.largest_shift.row > 0) {
    fmt::print("largest correction of the functional point {:.3f} um", 1e3 * result.largest_shift.value);
    if (!result.uncertainty.empty())
      fmt::print(", standard uncertainty {:.3f} um", 1e3 * result.uncertainty[result.largest_shift.row - 1]);
    fmt::print(", {}\n", pose_words(machine, poses, result.largest_shift.row));
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (result.by_axis[i].row == 0) continue;
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    fmt::print("  {:<3} {:>10.3f} {:<4}, row {}\n", machine.axes[i].name,
               micro_per_unit(rotary) * result.by_axis[i].value, micro_unit(rotary), result.by_axis[i].row);
  }
  fmt::print(
      "what is left: at most {:.1e} mm{} and {:.1e} rad{}\n", result.largest_position_left.value,
      result.largest_position_left.value > 1e-9 ? fmt::format(" in row {}", result.largest_position_left.row) : "",
      result.largest_orientation_left.value,
      result.largest_orientation_left.value > 1e-11 ? fmt::format(" in row {}", result.largest_orientation_left.row)
                                                    : "");
  if (command.leave_out_factor > 0)
    fmt::print("{}", left_out_text(machine, command.leave_out_factor, result.left_out, ""));
}

nlohmann::ordered_json poses_json(const PosesCommand& command, const Machine& machine, const PoseList& poses,
                                  const CorrectedPoses& result, bool written) {
  nlohmann::ordered_json json;
  json["machine"] = machine.name;
  json["poses"] = poses.count();
  json["written"] = written;
  for (std::size_t s = 1; s < kCorrectionStatuses; ++s)
    json["status"][correction_status_text(static_cast<CorrectionStatus>(s))] = result.count[s];
  json["largest_correction_um"] = 1e3 * result.largest_shift.value;
  json["largest_correction_row"] = result.largest_shift.row;
  if (!result.uncertainty.empty() && result.largest_shift.row > 0)
    json["standard_uncertainty_um"] = 1e3 * result.uncertainty[result.largest_shift.row - 1];
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    json["axes"].push_back({{"axis", machine.axes[i].name},
                            {rotary ? "largest_urad" : "largest_um", micro_per_unit(rotary) * result.by_axis[i].value},
                            {"row", result.by_axis[i].row}});
  }
  json["largest_position_left_um"] = 1e3 * result.largest_position_left.value;
  json["largest_orientation_left_urad"] = 1e6 * result.largest_orientation_left.value;
  state_left_out(machine, result.left_out, json);
  json["output"] = command.output;
  return json;
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

  const CorrectedPoses result = corrected_poses(command, machine, errors, poses);
  const bool refused = !(1e3 * result.largest_shift.value <= limit_um);
  const bool written = !refused && !command.dry_run;
  if (written) write_file_atomically(command.output, poses_csv(machine, result));
  if (command.json) {
    fmt::print("{}", json_text(poses_json(command, machine, poses, result, written)));
  } else {
    print_poses(command, machine, poses, result);
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
      "  abbe compensate poses examples/machines/trunnion-mill.machine.toml examples/compensate/trunnion.errors.toml "
      "examples/compensate/poses.csv -o corrected.csv\n\n"
      "Every row of the output has a status: reached; orientation left or turn limited (the point is exact, and the\n"
      "remaining orientation error is stated); position left, outside travel, not covered or not converged (exit code "
      "1).\n"
      "See docs/compensation.md.");
  command->add_option("machine", options->machine, "Machine file (*.machine.toml)")->required();
  command->add_option("errors", options->errors, "Errors file (*.errors.toml)")->required();
  command->add_option("poses", options->poses, "CSV with one column of commands per axis (X_mm, C_deg, ...)")
      ->required();
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
