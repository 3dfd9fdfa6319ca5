#pragma once

#include <Eigen/Core>

namespace abbe {

/// Cross-product matrix: skew(a) * b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& a);

/// Rotation by `angle` (rad) about a unit axis, right-hand rule.
Eigen::Matrix3d rotation_about(const Eigen::Vector3d& unit_axis, double angle);

/// Rotation of the error angles (EA, EB, EC), rad: Rz(EC) * Ry(EB) * Rx(EA), exact.
///
/// Source: the composition order is fixed in docs/conventions.md.
Eigen::Matrix3d rotation_from_error_angles(const Eigen::Vector3d& angles);

/// Inverse of rotation_from_error_angles for |EB| < pi/2.
Eigen::Vector3d error_angles_from_rotation(const Eigen::Matrix3d& rotation);

/// Columns: the axes, in the fixed frame, about which a change of EA, EB, EC turns Rz(EC) Ry(EB) Rx(EA).
Eigen::Matrix3d error_angle_axes(const Eigen::Vector3d& angles);

/// Rotation vector (axis times angle, rad, angle in [0, pi]) of a rotation matrix; exact to rounding for small angles.
Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation);

/// Rotation matrix of a rotation vector (rad).
Eigen::Matrix3d rotation_from_vector(const Eigen::Vector3d& vector);

/// The smallest rotation that turns the direction `from` into the direction `to`; lengths do not matter. Opposite
/// directions are turned about any axis across them.
Eigen::Matrix3d rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace abbe
