#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/inverse_kinematics.h"
#include "abbe/machine/six_axis_loop.h"

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Margin below which two branches count as one, or an axis as free.
constexpr double kSingularArm = 1e-7;

/// 1 / |J^-1|, or 0; for a point of its position alone.
double margin(const LoopMatrix& jacobian, std::size_t axes) {
  if (axes == 3) {
    const FullLu<3> of_point(jacobian.topLeftCorner<3, 3>());
    return of_point.rank() == 3 ? 1 / of_point.inverse().norm() : 0;
  }
  const FullLu<6> whole(jacobian);
  return whole.rank() == 6 ? 1 / whole.inverse().norm() : 0;
}

/// A jointed arm and a target as a loop of six axes: what the target leaves free of the orientation is turned by axes
/// that the machine does not have, through the functional point.
struct ArmLoop {
  SixAxisLoop loop;
  Vector3d tool = Vector3d::Zero();  ///< functional point with the working axes at zero
};

ArmLoop arm_loop(const Machine& machine, const InversePlan& plan, const PoseTarget& target,
                 const std::array<double, kMaxAxes>& command) {
  ArmLoop arm;
  SixAxisLoop& loop = arm.loop;
  RigidTransform held;  // displacement by the held axes passed so far
  std::size_t next = 0;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    if (next < plan.arm_count && plan.arm[next] == i) {
      loop.direction[next] = held.rotation * axis.direction;
      loop.point[next++] = held * axis.point;
    } else if (axis.kind == AxisKind::rotary) {
      const Matrix3d turn = rotation_about(axis.direction, chain_sign(axis) * command[i]);
      held = held * RigidTransform{turn, axis.point - turn * axis.point};
    } else {
      held.translation += chain_sign(axis) * command[i] * (held.rotation * axis.direction);
    }
  }
  arm.tool = held * (machine.tool_reference + machine.tool_offset);
  const Vector3d direction = held.rotation * machine.tool_direction;
  const Matrix3d& frame = machine.bed_from_workpiece.rotation;
  if (target.kind == TargetKind::full_pose) {
    loop.target.rotation = frame * target.orientation * held.rotation.transpose();
  } else if (target.kind == TargetKind::point_and_direction) {
    loop.target.rotation = rotation_between(direction, frame * target.direction.stableNormalized());
    loop.direction[5] = direction;
    loop.point[5] = arm.tool;
  } else {
    loop.target.rotation.setIdentity();
    for (std::size_t k = 3; k < kLoopAxes; ++k) {
      loop.direction[k] = Vector3d::Unit(static_cast<Eigen::Index>(k - 3));
      loop.point[k] = arm.tool;
    }
  }
  loop.target.translation = machine.bed_from_workpiece * target.point - loop.target.rotation * arm.tool;
  return arm;
}

}  // namespace

void InverseKinematics::solve_arm(const InversePlan& plan, const PoseTarget& target, const Start& start,
                                  InverseResult& result) const {
  InverseSolution solution;
  solution.position = plan.command;
  for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
    if (plan.held[i] && !plan.held_by_option[i]) solution.position[i] = start.position[i];
  }
  const ArmLoop arm = arm_loop(machine_, plan, target, solution.position);
  const double size = arm.loop.size();
  LoopAngles begin{};
  std::uint32_t working = 0;
  for (std::size_t k = 0; k < plan.arm_count; ++k) {
    begin[k] = chain_sign(machine_.axes[plan.arm[k]]) * start.position[plan.arm[k]];
    working |= 1U << plan.arm[k];
  }
  const auto take = [&](const LoopAngles& angles) {
    for (std::size_t k = 0; k < plan.arm_count; ++k) {
      solution.position[plan.arm[k]] = chain_sign(machine_.axes[plan.arm[k]]) * angles[k];
    }
  };
  const double tolerance = std::min(options_.orientation_tolerance, options_.position_tolerance / size);
  const LoopCandidates found = solve_loop(arm.loop, arm.tool, begin, tolerance, plan.arm_count);
  for (std::size_t k = 0; k < found.size(); ++k) {
    take(found[k].angle);
    LoopMatrix jacobian;
    missing_of(arm.loop, found[k].angle, arm.tool, size, &jacobian);
    solution.singular_margin = margin(jacobian, plan.arm_count);
    solution.branch = static_cast<int>(k);
    solution.singularity = PoseSingularity::none;
    solution.singular_axis = Machine::npos;
    std::uint32_t turning = working;
    if (found[k].free_axis < plan.arm_count) {
      solution.singular_axis = plan.arm[found[k].free_axis];
      solution.singularity = PoseSingularity::arm_dependent;
      solution.position[solution.singular_axis] = start.position[solution.singular_axis];
      turning &= ~(1U << solution.singular_axis);
    } else if (solution.singular_margin < kSingularArm) {
      solution.singularity = PoseSingularity::limit_of_reach;
    }
    add_turns(target, start, turning, 0, solution, result);
  }
  if (!result.solutions.empty()) return;
  // The nearest approach from the start, from zero, and from a pose without any singularity in common arms.
  solution.singularity = PoseSingularity::none;
  solution.singular_axis = Machine::npos;
  for (const LoopAngles& from : {begin, LoopAngles{}, LoopAngles{0.1, 0.8, -0.9, 0.3, 0.7, 0.2}}) {
    LoopAngles angles = from;
    approach(arm.loop, arm.tool, size, angles);
    take(angles);
    add_turns(target, start, working, 0, solution, result);
  }
}

}  // namespace abbe
