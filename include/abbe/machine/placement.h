#pragma once

#include <Eigen/Core>
#include <optional>

#include "abbe/geometry/rigid_transform.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Rx(alpha) Ry(beta) Rz(gamma), intrinsic X-Y-Z. Yin et al., Machines 9 (2021) 237, equation 8.
Eigen::Matrix3d rotation_xyz(const Eigen::Vector3d& angles);

/// (alpha, beta, gamma), rad, of a rotation; at cos(beta) = 0, where only one of them is free, alpha is 0.
Eigen::Vector3d angles_xyz(const Eigen::Matrix3d& rotation);

/// Where a workpiece is clamped: its frame seen from the frame that the machine calls the workpiece's (the table at
/// zero).
struct Placement {
  RigidTransform table_from_workpiece;
  /// Covariance of a small motion of the workpiece in the table's frame: translation of the workpiece's origin (mm),
  /// then rotation vector (rad).
  std::optional<Eigen::Matrix<double, 6, 6>> covariance = std::nullopt;
};

/// The machine with a workpiece clamped so.
Machine with_workpiece(Machine machine, const Placement& placement);

}  // namespace abbe
