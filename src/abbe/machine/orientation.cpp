#include "abbe/machine/orientation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "abbe/geometry/angle.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
/// Sides of the spherical triangle closer than this to a degenerate one (rad): the two branches are one.
constexpr double kMeetingAngle = 1e-12;

/// Angle of a rotation matrix, rad, [0, pi].
double rotation_angle(const Matrix3d& rotation) { return rotation_vector(rotation).norm(); }

RotaryBranches single(const RotaryAngles& angles) {
  RotaryBranches branches;
  branches.count = 1;
  branches.branch[0] = angles;
  return branches;
}

/// Two axes and a direction, see turn_direction.
RotaryBranches turn_direction_by_two(const Vector3d& first, const Vector3d& second, const Vector3d& start,
                                     const Vector3d& target, double held_first) {
  RotaryAngles angles;
  const double to_target = angle_between(first, target);
  if (std::min(to_target, kPi - to_target) < kSingularAngle) {
    const Vector3d turned_back = rotation_about(first, -held_first) * target;
    angles.angle = {held_first, angle_about(second, start, turned_back), 0};
    angles.miss = angle_between(rotation_about(second, angles.angle[1]) * start, turned_back);
    angles.singularity = RotarySingularity::first_axis_free;
    return single(angles);
  }
  // Spherical triangle with corners first, second, turned direction; sides as angles.
  const double axes = angle_between(first, second);
  const double to_start = angle_between(second, start);
  // Half the perimeter, and half the perimeter less each side: all in [0, pi] where a triangle exists.
  const double half = 0.5 * (axes + to_start + to_target);
  const double less_axes = 0.5 * (to_target + (to_start - axes));
  const double less_start = 0.5 * (to_target + (axes - to_start));
  const double less_target = 0.5 * ((axes + to_start) - to_target);
  const double gap = std::min({less_axes, less_start, less_target, kPi - half});
  angles.miss = std::max(0.0, -2 * gap);
  angles.margin = std::min({to_target, kPi - to_target, std::abs(2 * gap)});

  double at_first = 0, at_second = 0;
  const bool meets = gap <= kMeetingAngle;
  if (meets) {
    // The triangle lies on one great circle: each angle is 0 or pi.
    if (gap == less_start || gap == kPi - half) at_first = kPi;
    if (gap == less_target || gap == kPi - half) at_second = kPi;
  } else {
    const double a = std::sin(less_axes), s = std::sin(less_start), t = std::sin(less_target), h = std::sin(half);
    at_first = 2 * std::atan2(std::sqrt(a * t), std::sqrt(h * s));
    at_second = 2 * std::atan2(std::sqrt(a * s), std::sqrt(h * t));
  }
  const double azimuth_target = angle_about(first, second, target);
  const double azimuth_start = angle_about(second, first, start);
  RotaryBranches branches;
  branches.count = meets ? 1 : 2;
  for (int k = 0; k < branches.count; ++k) {
    const double sign = k == 0 ? 1 : -1;
    angles.angle = {azimuth_target - sign * at_first, -sign * at_second - azimuth_start, 0};
    angles.singularity = meets ? RotarySingularity::branches_meet : RotarySingularity::none;
    branches.branch[static_cast<std::size_t>(k)] = angles;
  }
  return branches;
}

/// Rotation about one axis that is nearest to the target.
double nearest_turn(const Vector3d& axis, const Matrix3d& target) {
  const Eigen::Quaterniond q(target);
  return 2 * std::atan2(q.vec().dot(axis), q.w());
}

/// Rotation by two axes that is nearest to the target: the scalar part of its conjugate times the two half-angle
/// quaternions is a bilinear form of (cos, sin) of the half angles and largest in closed form.
RotaryAngles nearest_two_turns(const Vector3d& a, const Vector3d& b, const Matrix3d& target) {
  const Eigen::Quaterniond q(target);
  const Vector3d v = q.vec();
  const double cc = q.w(), cs = v.dot(b), sc = v.dot(a);
  const double ss = v.dot(a.cross(b)) - q.w() * a.dot(b);
  const double difference = std::atan2(sc - cs, cc + ss);
  const double sum = std::atan2(sc + cs, cc - ss);
  RotaryAngles angles;
  angles.angle = {sum + difference, sum - difference, 0};
  return angles;
}

}  // namespace

double angle_about(const Vector3d& unit_axis, const Vector3d& from, const Vector3d& to) {
  // Of the parts across the axis, so that nothing is lost for vectors almost along it.
  const Vector3d across_from = unit_axis.cross(from), across_to = unit_axis.cross(to);
  return std::atan2(unit_axis.dot(across_from.cross(across_to)), across_from.dot(across_to));
}

RotaryBranches turn_direction(std::span<const Vector3d> axes, const Vector3d& start, const Vector3d& target,
                              double held_first) {
  assert(axes.size() <= 2);
  if (axes.size() == 2) return turn_direction_by_two(axes[0], axes[1], start, target, held_first);
  RotaryAngles angles;
  Vector3d reached = start;
  if (axes.size() == 1) {
    const double to_target = angle_between(axes[0], target);
    angles.margin = std::min(to_target, kPi - to_target);
    const bool free = angles.margin < kSingularAngle;
    angles.angle[0] = free ? held_first : angle_about(axes[0], start, target);
    if (free) angles.singularity = RotarySingularity::first_axis_free;
    reached = rotation_about(axes[0], angles.angle[0]) * start;
  }
  angles.miss = angle_between(reached, target);
  return single(angles);
}

RotaryBranches turn_frame(std::span<const Vector3d> axes, const Matrix3d& target, double held_first) {
  assert(axes.size() <= 3);
  RotaryAngles angles;
  if (axes.empty()) {
    angles.miss = rotation_angle(target);
    return single(angles);
  }
  if (axes.size() == 1) {
    angles.angle[0] = nearest_turn(axes[0], target);
    angles.miss = rotation_angle(rotation_about(axes[0], -angles.angle[0]) * target);
    angles.margin = kPi;
    return single(angles);
  }
  if (axes.size() == 2) {
    angles = nearest_two_turns(axes[0], axes[1], target);
    angles.miss =
        rotation_angle(rotation_about(axes[1], -angles.angle[1]) * rotation_about(axes[0], -angles.angle[0]) * target);
    angles.margin = angle_between(axes[0], axes[1]);
    return single(angles);
  }
  // The third axis leaves its own direction alone: the first two must bring it to where the target has it.
  RotaryBranches branches = turn_direction_by_two(axes[0], axes[1], axes[2], target * axes[2], held_first);
  for (int k = 0; k < branches.count; ++k) {
    RotaryAngles& branch = branches.branch[static_cast<std::size_t>(k)];
    const Matrix3d rest =
        rotation_about(axes[1], -branch.angle[1]) * rotation_about(axes[0], -branch.angle[0]) * target;
    branch.angle[2] = nearest_turn(axes[2], rest);
    branch.miss = rotation_angle(rotation_about(axes[2], -branch.angle[2]) * rest);
  }
  return branches;
}

}  // namespace abbe
