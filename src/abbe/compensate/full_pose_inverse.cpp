#include "abbe/compensate/full_pose_inverse.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/machine_check.h"

namespace abbe {
namespace {

constexpr double kLever = 1e3;           // mm; a turn of 1 mrad counts as 1 mm
constexpr double kStandingArm = 1e-12;   // rad; a step below it is rounding
constexpr double kSingularPoint = 1e-9;  // of the largest singular value: the point cannot be moved that way

/// Where the tool is missing, workpiece frame: mm and rad.
struct Missing {
  Eigen::Vector3d point, turn;
};

Missing missing_of(const RigidTransform& wanted, const RigidTransform& actual) {
  return {wanted.translation - actual.translation, rotation_vector(wanted.rotation * actual.rotation.transpose())};
}

/// y = V diag(s / max(s^2, t^2)) U'b with t = |b| / largest, as bounded_least_squares() for any size.
Eigen::VectorXd bounded_turn(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double largest, bool& bounded) {
  const SingularValues<> svd(a);
  const double t = b.norm() / largest;
  Eigen::VectorXd z = Eigen::VectorXd::Zero(a.cols());
  bounded = false;
  for (Eigen::Index i = 0; i < svd.values().size(); ++i) {
    const double s = svd.values()[i], divisor = std::max(s * s, t * t);
    if (divisor > 0) z[i] = s * svd.u().col(i).dot(b) / divisor;
    bounded = bounded || s < t;
  }
  return svd.v() * z;
}

}  // namespace

FullPoseInverse::FullPoseInverse(const Machine& machine, const ErrorSet& errors, const FullPoseOptions& options,
                                 std::span<const std::size_t> held)
    : machine_(machine), errors_(errors), options_(options) {
  const std::vector<MachineProblem> problems = find_problems(machine);
  if (!problems.empty()) {
    problem_ = problems.front().text();
    return;
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (std::find(held.begin(), held.end(), i) == held.end()) working_.push_back(i);
  }
}

FullPoseResult FullPoseInverse::reach(const RigidTransform& wanted, std::span<const double> start) const {
  FullPoseResult result;
  result.commands.assign(start.begin(), start.end());
  result.position_left = result.orientation_left = std::numeric_limits<double>::quiet_NaN();
  if (!problem_.empty()) return result;
  const auto number = [](double value) { return std::isfinite(value); };
  if (!std::all_of(start.begin(), start.end(), number) || !wanted.translation.allFinite() ||
      !wanted.rotation.allFinite()) {
    result.status = CorrectionStatus::not_finite;
    return result;
  }
  const auto count = static_cast<Eigen::Index>(working_.size());
  const auto unit = [&](std::size_t i) { return machine_.axes[i].kind == AxisKind::linear ? kLever : 1.0; };
  std::vector<double> commands(start.begin(), start.end());
  Deviation deviation;
  Eigen::MatrixXd by_positions;
  if (tool_deviation(machine_, errors_, commands, deviation) != PoseStatus::ok) {
    result.status = CorrectionStatus::not_covered;
    return result;
  }
  const Missing at_start = missing_of(wanted, actual_workpiece_from_tool(machine_, errors_, commands));
  result.status = CorrectionStatus::not_converged;
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(count);  // rad, or kLever mm
  bool turn_bounded = false;
  Missing missing = at_start;
  for (int round = 0; round < options_.largest_iterations; ++round) {
    const bool at_point = missing.point.norm() <= options_.position_tolerance;
    if (at_point && missing.turn.norm() <= options_.orientation_tolerance) {
      result.status = CorrectionStatus::reached;
      break;
    }
    // The derivative needs no range: a correction may lead out of it by its own size.
    tool_deviation(machine_, errors_, commands, deviation, nullptr, &by_positions);
    Eigen::MatrixXd to_point(3, count), to_turn(3, count);
    for (Eigen::Index c = 0; c < count; ++c) {
      const std::size_t axis = working_[static_cast<std::size_t>(c)];
      to_point.col(c) = unit(axis) * by_positions.col(static_cast<Eigen::Index>(axis)).head<3>();
      to_turn.col(c) = unit(axis) * by_positions.col(static_cast<Eigen::Index>(axis)).tail<3>();
    }
    const Eigen::VectorXd point = missing.point + to_point * moved, turn = missing.turn + to_turn * moved;
    const CompleteOrthogonal pseudo(to_point, kSingularPoint);
    const Eigen::MatrixXd inverse = pseudo.pseudo_inverse();
    const Eigen::MatrixXd free = Eigen::MatrixXd::Identity(count, count) - inverse * to_point;
    const Eigen::VectorXd by_point = inverse * point;
    const Eigen::VectorXd by_turn =
        free * bounded_turn(to_turn * free, turn - to_turn * by_point, options_.largest_turn, turn_bounded);
    const Eigen::VectorXd next = by_point + by_turn;
    const double step = (next - moved).norm();
    if (step <= kStandingArm) {
      result.status = !at_point      ? CorrectionStatus::position_left
                      : turn_bounded ? CorrectionStatus::turn_limited
                                     : CorrectionStatus::orientation_left;
      break;
    }
    moved = next;
    for (Eigen::Index c = 0; c < count; ++c) {
      const std::size_t axis = working_[static_cast<std::size_t>(c)];
      commands[axis] = start[axis] + unit(axis) * moved[c];
    }
    missing = missing_of(wanted, actual_workpiece_from_tool(machine_, errors_, commands));
    if (!missing.point.allFinite() || !missing.turn.allFinite()) break;
  }
  if (reaches_point(result.status)) {
    for (std::size_t i = 0; i < commands.size(); ++i) {
      const Axis& axis = machine_.axes[i];
      if (axis.endless || (commands[i] >= axis.travel_min && commands[i] <= axis.travel_max)) continue;
      result.status = CorrectionStatus::outside_travel;
    }
  }
  const bool taken = reaches_point(result.status);
  if (taken) result.commands = commands;
  const Missing& left = taken ? missing : at_start;
  result.position_left = left.point.norm();
  result.orientation_left = left.turn.norm();
  return result;
}

}  // namespace abbe
