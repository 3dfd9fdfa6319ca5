#include "abbe/compensate/corrected_poses.h"

#include <cmath>

#include "abbe/compensate/program/program_uncertainty.h"
#include "abbe/compensate/working_axes.h"
#include "abbe/errors/actual_pose.h"
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
                       CorrectedPoses& result) {
  for (std::size_t k = 0; k < poses.count(); ++k) {
    if (!std::isfinite(result.position_left[k])) continue;
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, poses.pose(k));
    const RigidTransform actual = actual_workpiece_from_tool(machine, errors, result.commands.pose(k));
    result.position_left[k] = (actual.translation - wanted.translation).norm();
    result.orientation_left[k] =
        target == TargetKind::full_pose
            ? rotation_vector(wanted.rotation * actual.rotation.transpose()).norm()
            : angle_between(actual.rotation * machine.tool_direction, wanted.rotation * machine.tool_direction);
  }
}

/// Six axes of an arm are there for the whole pose; machine tools turn the tool about itself.
bool serves_whole_pose(const Machine& machine, const std::vector<std::size_t>& held) {
  std::vector<HeldAxis> kept;
  for (const std::size_t axis : held) {
    if (axis >= machine.axes.size()) return false;
    kept.push_back({axis, 0});
  }
  return find_problems(machine).empty() && working_axes(machine, TargetKind::full_pose, kept).arm.size() == 6;
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
  options.largest_turn = asked.largest_turn;
  if (serves_whole_pose(machine, asked.held)) options.target = TargetKind::full_pose;
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
  inverse.correct({in, count},
                  {out, result.status.data(), result.position_left.data(), result.orientation_left.data()});

  if (!result.left_out.names.empty()) state_left_by_all(machine, errors, poses, options.target, result);
  const bool stated = !covariance.isZero(0);
  const std::vector<bool> moved(machine.axes.size(), true);
  for (std::size_t k = 0; k < count; ++k) {
    Deviation deviation;
    const bool known = tool_deviation(machine, corrected, poses.pose(k), deviation) == PoseStatus::ok;
    result.shift.push_back(known ? deviation.head<3>().norm() : std::nan(""));
    if (!stated) continue;
    ProgramPlace place;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) place.position[i] = poses.axis[i][k];
    result.uncertainty.push_back(known ? uncertainty_at(machine, errors, covariance, place, moved).point
                                       : std::nan(""));
  }
  state_statistics(machine, poses, result);
  return result;
}

}  // namespace abbe
