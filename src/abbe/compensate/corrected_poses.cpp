#include "abbe/compensate/corrected_poses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "abbe/compensate/program/program_uncertainty.h"
#include "abbe/compensate/working_axes.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/error_states.h"
#include "abbe/geometry/angle.h"
#include "abbe/geometry/decompositions.h"
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

/// Where the tool shall be at every pose.
class WantedPoses {
 public:
  WantedPoses(const Machine& machine, const PoseList& poses, const std::optional<WorkpieceExpansion>& workpiece)
      : machine_(machine), poses_(poses), workpiece_(workpiece) {}

  RigidTransform at(std::size_t k) const {
    RigidTransform wanted = nominal_workpiece_from_tool(machine_, poses_.pose(k));
    if (workpiece_) wanted.translation = expanded_point(*workpiece_, factor(k), wanted.translation);
    return wanted;
  }

  /// From the pose at the commands to the wanted one, mm.
  Eigen::Vector3d shift(std::size_t k) const {
    return at(k).translation - nominal_workpiece_from_tool(machine_, poses_.pose(k)).translation;
  }

  /// Of the wanted point, mm^2.
  Eigen::Matrix3d covariance(std::size_t k) const {
    const Eigen::Vector3d point = nominal_workpiece_from_tool(machine_, poses_.pose(k)).translation;
    return expanded_point_covariance(*workpiece_, factor(k), point);
  }

 private:
  double factor(std::size_t k) const { return workpiece_factor(machine_, *workpiece_, poses_, k); }

  const Machine& machine_;
  const PoseList& poses_;
  const std::optional<WorkpieceExpansion>& workpiece_;
};

/// Commands for the points of an expanded workpiece.
void reach_wanted(const Machine& machine, const CompensatedInverse& inverse, const WantedPoses& wanted,
                  const PositionArrays& commands, const CorrectedArrays& corrected) {
  std::array<std::vector<double>, 15> columns;  // point, direction, rotation by rows
  for (std::vector<double>& column : columns) column.resize(commands.count);
  for (std::size_t k = 0; k < commands.count; ++k) {
    const RigidTransform pose = wanted.at(k);
    const Eigen::Vector3d direction = pose.rotation * machine.tool_direction;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      columns[i][k] = pose.translation[row];
      columns[3 + i][k] = direction[row];
      for (std::size_t j = 0; j < 3; ++j) {
        columns[6 + 3 * i + j][k] = pose.rotation(row, static_cast<Eigen::Index>(j));
      }
    }
  }
  TargetArrays targets;
  targets.point = {columns[0].data(), columns[1].data(), columns[2].data()};
  targets.direction = {columns[3].data(), columns[4].data(), columns[5].data()};
  for (std::size_t i = 0; i < 9; ++i) targets.rotation[i] = columns[6 + i].data();
  inverse.reach(commands, targets, corrected);
}

/// Standard uncertainty along a correction: of the errors and of the workpiece, mm.
double uncertainty_along(const Eigen::MatrixXd& by_parameters, const Eigen::MatrixXd& covariance,
                         const Eigen::Matrix3d& of_workpiece, const Eigen::Vector3d& shift) {
  const Eigen::MatrixXd rows = by_parameters.topRows<3>();
  const Eigen::Matrix3d spread = rows * covariance * rows.transpose() + of_workpiece;
  const double variance = shift.norm() > 0 ? shift.normalized().dot(spread * shift.normalized())
                                           : SymmetricEigen<3>(spread).eigenvalues()[2];
  return std::sqrt(std::max(0.0, variance));
}

/// Corrections of the point, and their uncertainties, where the workpiece expands.
/// @param all  errors, those included that are left out of the corrected ones
void state_shifts(const Machine& machine, const ErrorSet& all, const ErrorSet& corrected,
                  const Eigen::MatrixXd& covariance, const WorkpieceExpansion& workpiece, const PoseList& poses,
                  const WantedPoses& wanted, CorrectedPoses& result) {
  const GivenStates states(machine, all);
  const bool stated =
      !covariance.isZero(0) || workpiece.standard_uncertainty > 0 || workpiece.temperature_uncertainty > 0;
  for (std::size_t k = 0; k < poses.count(); ++k) {
    const std::vector<double> at = states.at(poses, k);
    Deviation deviation, of_all;
    Eigen::MatrixXd by_parameters;
    const bool known =
        tool_deviation(machine, corrected, poses.pose(k), deviation, nullptr, nullptr, at) == PoseStatus::ok &&
        tool_deviation(machine, all, poses.pose(k), of_all, &by_parameters, nullptr, at) == PoseStatus::ok &&
        wanted.shift(k).allFinite();
    const Eigen::Vector3d shift = deviation.head<3>() - wanted.shift(k);
    result.shift.push_back(known ? shift.norm() : std::nan(""));
    if (!stated) continue;
    result.uncertainty.push_back(known ? uncertainty_along(by_parameters, covariance, wanted.covariance(k), shift)
                                       : std::nan(""));
  }
}

/// What stays of all errors, those included that were left out.
void state_left_by_all(const Machine& machine, const ErrorSet& errors, const PoseList& poses, TargetKind target,
                       const GivenStates& states, const WantedPoses& wanted_poses, CorrectedPoses& result) {
  for (std::size_t k = 0; k < poses.count(); ++k) {
    if (!std::isfinite(result.position_left[k])) continue;
    const RigidTransform wanted = wanted_poses.at(k);
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
  const WantedPoses wanted(machine, poses, asked.workpiece);
  const CorrectedArrays arrays{out, result.status.data(), result.position_left.data(), result.orientation_left.data()};
  if (asked.workpiece) {
    reach_wanted(machine, inverse, wanted, {in, count, given}, arrays);
  } else {
    inverse.correct({in, count, given}, arrays);
  }

  if (!result.left_out.names.empty()) {
    state_left_by_all(machine, errors, poses, options.target, GivenStates(machine, errors), wanted, result);
  }
  const bool stated = !covariance.isZero(0);
  if (asked.workpiece) {
    state_shifts(machine, errors, corrected, covariance, *asked.workpiece, poses, wanted, result);
    state_statistics(machine, poses, result);
    return result;
  }
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
