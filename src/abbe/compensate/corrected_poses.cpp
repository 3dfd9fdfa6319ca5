#include "abbe/compensate/corrected_poses.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "abbe/compensate/program/program_uncertainty.h"
#include "abbe/compensate/working_axes.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/error_states.h"
#include "abbe/geometry/angle.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/machine_check.h"

namespace abbe {
namespace {

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
void state_left_by_all(const Machine& machine, const ErrorSet& errors, const PoseList& poses, TargetKind target,
                       const GivenStates& states, CorrectedPoses& result) {
  for (std::size_t k = 0; k < poses.count(); ++k) {
    if (!std::isfinite(result.position_left[k])) continue;
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, poses.pose(k));
    const RigidTransform actual =
        actual_workpiece_from_tool(machine, errors, result.commands.pose(k), states.at(poses, k));
    result.position_left[k] = (actual.translation - wanted.translation).norm();
    result.orientation_left[k] =
        target == TargetKind::full_pose
            ? rotation_vector(wanted.rotation * actual.rotation.transpose()).norm()
            : angle_between(actual.rotation * machine.tool_direction, wanted.rotation * machine.tool_direction);
  }
}

/// As pose_target(); what is wrong with the machine or with what is held, the inverse says.
TargetKind target_of(const Machine& machine, const std::vector<std::size_t>& held) {
  std::vector<HeldAxis> kept;
  for (const std::size_t axis : held) kept.push_back({axis, 0});
  const bool exist = std::all_of(held.begin(), held.end(), [&](std::size_t i) { return i < machine.axes.size(); });
  return exist && find_problems(machine).empty() ? pose_target(machine, kept) : TargetKind::point_and_direction;
}

}  // namespace

CorrectedPoses corrected_poses(const Machine& machine, const ErrorSet& errors, const Eigen::MatrixXd& stated_covariance,
                               const PoseList& poses, const CorrectedPosesOptions& asked) {
  CorrectedPoses result;
  const Eigen::MatrixXd covariance = parameter_covariance(errors, stated_covariance);
  ErrorSet corrected = errors;
  if (asked.leave_out_factor > 0)
    result.left_out = leave_out_uncertain(machine, corrected, covariance, asked.leave_out_factor);
  CorrectionOptions options;
  options.target = target_of(machine, asked.held);
  options.largest_turn =
      asked.largest_turn.value_or(options.target == TargetKind::full_pose ? kLargestTurnOfArm : kLargestTurn);
  const CompensatedInverse inverse(machine, corrected, options, asked.held);
  result.problem = inverse.problem();
  if (!result.problem.empty()) return result;

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
  const GivenStates states(machine, corrected);
  std::vector<double> memory;
  std::vector<const double*> given;
  std::vector<std::size_t> all(count);
  std::iota(all.begin(), all.end(), std::size_t{0});
  states.gather(poses, all, memory, given);
  inverse.correct({in, count, given},
                  {out, result.status.data(), result.position_left.data(), result.orientation_left.data()});

  if (!result.left_out.names.empty()) {
    state_left_by_all(machine, errors, poses, options.target, GivenStates(machine, errors), result);
  }
  const bool stated = !covariance.isZero(0);
  const std::vector<bool> moved(machine.axes.size(), true);
  for (std::size_t k = 0; k < count; ++k) {
    Deviation deviation;
    const std::vector<double> at = states.at(poses, k);
    const bool known =
        tool_deviation(machine, corrected, poses.pose(k), deviation, nullptr, nullptr, at) == PoseStatus::ok;
    result.shift.push_back(known ? deviation.head<3>().norm() : std::nan(""));
    if (!stated) continue;
    ProgramPlace place;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) place.position[i] = poses.axis[i][k];
    result.uncertainty.push_back(known ? uncertainty_at(machine, errors, covariance, place, moved, at).point
                                       : std::nan(""));
  }
  state_statistics(machine, poses, result);
  return result;
}

}  // namespace abbe
