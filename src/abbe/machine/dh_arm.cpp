#include "abbe/machine/dh_arm.h"

#include <cmath>

namespace abbe {
namespace {

/// Sine and cosine; those of right angles are exact.
void exact_turn(double angle, double& sine, double& cosine) {
  sine = std::sin(angle);
  cosine = std::cos(angle);
  // What is left of a right angle in rad, up to two turns.
  constexpr double kRounding = 1e-15;
  if (std::abs(sine) < kRounding) {
    sine = 0;
    cosine = cosine < 0 ? -1 : 1;
  } else if (std::abs(cosine) < kRounding) {
    cosine = 0;
    sine = sine < 0 ? -1 : 1;
  }
}

/// Without zeros below zero, which right angles make.
Eigen::Vector3d without_negative_zeros(const Eigen::Vector3d& vector) { return vector + Eigen::Vector3d::Zero(); }

/// Rot_x(alpha) Trans_x(a), which commute.
RigidTransform along_x(const DhJoint& joint) {
  double s, c;
  exact_turn(joint.alpha, s, c);
  RigidTransform result;
  result.rotation << 1, 0, 0, 0, c, -s, 0, s, c;
  result.translation = {joint.a, 0, 0};
  return result;
}

/// Rot_z(theta) Trans_z(d) at a command.
RigidTransform along_z(const DhJoint& joint, double command) {
  const double moved = joint.reversed ? -command : command;
  double s, c;
  exact_turn(joint.theta + (joint.kind == AxisKind::rotary ? moved : 0), s, c);
  RigidTransform result;
  result.rotation << c, -s, 0, s, c, 0, 0, 0, 1;
  result.translation = {0, 0, joint.d + (joint.kind == AxisKind::linear ? moved : 0)};
  return result;
}

}  // namespace

RigidTransform dh_pose(const DhArm& arm, std::span<const double> commands) {
  RigidTransform frame = arm.workpiece_from_base;
  std::vector<double> positions(commands.begin(), commands.end());
  for (const AxisCoupling& coupling : arm.couplings) positions[coupling.axis] += coupling.ratio * commands[coupling.of];
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const RigidTransform x = along_x(arm.joints[i]), z = along_z(arm.joints[i], positions[i]);
    frame = frame * (arm.convention == DhConvention::standard ? z * x : x * z);
  }
  return frame * arm.last_from_tool;
}

Machine machine_from_dh(const DhArm& arm) {
  Machine machine;
  machine.name = arm.name;
  machine.description = arm.description;
  machine.couplings = arm.couplings;
  RigidTransform frame = arm.workpiece_from_base;
  for (const DhJoint& joint : arm.joints) {
    const RigidTransform x = along_x(joint), z = along_z(joint, 0);
    if (arm.convention == DhConvention::modified) frame = frame * x;
    Axis& axis = machine.axes.emplace_back();
    axis.name = joint.name;
    axis.kind = joint.kind;
    axis.direction = (joint.reversed ? -1.0 : 1.0) * frame.rotation.col(2);
    axis.point = frame.translation;
    axis.travel_min = joint.travel_min;
    axis.travel_max = joint.travel_max;
    axis.endless = joint.endless;
    frame = frame * z;
    if (arm.convention == DhConvention::standard) frame = frame * x;
  }
  const RigidTransform at_zero = frame * arm.last_from_tool;
  const Eigen::Matrix3d machine_from_workpiece = at_zero.rotation.transpose() + Eigen::Matrix3d::Zero();
  machine.bed_from_workpiece = RigidTransform::rotate(machine_from_workpiece);
  for (Axis& axis : machine.axes) {
    axis.direction = without_negative_zeros((machine_from_workpiece * axis.direction).normalized());
    axis.point = without_negative_zeros(machine_from_workpiece * axis.point);
  }
  machine.tool_reference = without_negative_zeros(machine_from_workpiece * frame.translation);
  machine.tool_offset =
      without_negative_zeros(machine_from_workpiece * (frame.rotation * arm.last_from_tool.translation));
  machine.tool_direction = {0, 0, -1};
  return machine;
}

}  // namespace abbe
