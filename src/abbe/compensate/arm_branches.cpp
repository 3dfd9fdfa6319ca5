#include <algorithm>
#include <cmath>

#include "abbe/compensate/full_pose_inverse.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_stream.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

constexpr double kArmLever = 1e3;  // mm; a turn of 1 mrad counts as 1 mm
constexpr int kStarts = 160;       // of which each finds one branch, mostly
constexpr int kMostSteps = 100;
constexpr double kSameBranch = 1e-6;  // rad, of every axis
constexpr double kSingular = 1e-5;    // smallest singular value of the derivative, rad per rad with kArmLever

using Vector6 = Eigen::Matrix<double, 6, 1>;

double arm_unit(const Axis& axis) { return axis.kind == AxisKind::linear ? kArmLever : 1.0; }

Eigen::MatrixXd arm_derivative(const Machine& machine, const std::vector<double>& commands) {
  Deviation deviation;
  Eigen::MatrixXd by_positions;
  tool_deviation(machine, ErrorSet{}, commands, deviation, nullptr, &by_positions);
  for (Eigen::Index c = 0; c < by_positions.cols(); ++c)
    by_positions.col(c) *= arm_unit(machine.axes[static_cast<std::size_t>(c)]);
  by_positions.topRows<3>() /= kArmLever;
  return by_positions;
}

Vector6 arm_missing(const Machine& machine, const RigidTransform& wanted, const std::vector<double>& commands) {
  const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
  Vector6 missing;
  missing << (wanted.translation - pose.translation) / kArmLever,
      rotation_vector(wanted.rotation * pose.rotation.transpose());
  return missing;
}

/// Levenberg-Marquardt steps whose damping is half of what is missing, squared; false: it does not get there.
bool solve_from(const Machine& machine, const RigidTransform& wanted, std::vector<double>& commands) {
  constexpr double kThere = 1e-12, kLeastDamping = 1e-16;
  Vector6 missing = arm_missing(machine, wanted, commands);
  double last = missing.norm();
  for (int step = 0; step < kMostSteps; ++step) {
    const Eigen::MatrixXd derivative = arm_derivative(machine, commands);
    const double damping = 0.5 * missing.squaredNorm() + kLeastDamping;
    const Eigen::MatrixXd normal =
        derivative.transpose() * derivative + damping * Eigen::MatrixXd::Identity(derivative.cols(), derivative.cols());
    const Eigen::VectorXd change = Cholesky(normal).solve(derivative.transpose() * missing);
    for (std::size_t i = 0; i < commands.size(); ++i)
      commands[i] += arm_unit(machine.axes[i]) * change[static_cast<Eigen::Index>(i)];
    missing = arm_missing(machine, wanted, commands);
    const double now = missing.norm();
    if (!std::isfinite(now)) return false;
    // Once it is near, it goes on until rounding stops it.
    if (now < kThere && now >= 0.5 * last) return true;
    last = now;
  }
  return last < 1e-10;
}

/// All commands within travel that differ from these by whole turns of rotary axes.
void add_turns_within_travel(const Machine& machine, std::vector<double> commands, std::size_t axis,
                             std::vector<std::vector<double>>& found) {
  if (axis == commands.size()) {
    const auto is_same = [&](const std::vector<double>& other) {
      for (std::size_t i = 0; i < other.size(); ++i) {
        if (std::abs(other[i] - commands[i]) > kSameBranch * arm_unit(machine.axes[i])) return false;
      }
      return true;
    };
    if (std::none_of(found.begin(), found.end(), is_same)) found.push_back(commands);
    return;
  }
  const Axis& a = machine.axes[axis];
  const double command = commands[axis];
  if (a.kind == AxisKind::linear) {
    if (command >= a.travel_min && command <= a.travel_max) add_turns_within_travel(machine, commands, axis + 1, found);
  } else if (a.endless) {
    commands[axis] = std::remainder(command, kTurn);
    add_turns_within_travel(machine, commands, axis + 1, found);
  } else {
    // What is at an end of the travel to rounding is within it.
    constexpr double kRounding = 1e-9;
    const double first = std::ceil((a.travel_min - kRounding - command) / kTurn);
    const double last = std::floor((a.travel_max + kRounding - command) / kTurn);
    for (double turns = first; turns <= last && turns < first + 20; ++turns) {
      commands[axis] = std::clamp(command + turns * kTurn, a.travel_min, a.travel_max);
      add_turns_within_travel(machine, commands, axis + 1, found);
    }
  }
}

}  // namespace

ArmBranches arm_branches(const Machine& machine, const RigidTransform& workpiece_from_tool) {
  ArmBranches result;
  RandomStream random(1, 0);
  for (int start = 0; start < kStarts; ++start) {
    std::vector<double> commands;
    for (const Axis& axis : machine.axes) {
      const double from = axis.endless ? -kTurn / 2 : axis.travel_min, to = axis.endless ? kTurn / 2 : axis.travel_max;
      commands.push_back(from + (to - from) * random.uniform());
    }
    if (!solve_from(machine, workpiece_from_tool, commands)) continue;
    const std::size_t before = result.commands.size();
    add_turns_within_travel(machine, commands, 0, result.commands);
    if (result.commands.size() == before) continue;
    const SingularValues<> svd(arm_derivative(machine, commands));
    if (svd.values()[svd.values().size() - 1] < kSingular) {
      result.is_singular = true;
      return result;
    }
  }
  std::sort(result.commands.begin(), result.commands.end());
  return result;
}

}  // namespace abbe
