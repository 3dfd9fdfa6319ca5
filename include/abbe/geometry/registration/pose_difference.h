#pragma once

#include <Eigen/Core>
#include <span>

#include "abbe/geometry/rigid_transform.h"

namespace abbe {

/// A motion of a scan that its points on a surface do not tell from none.
struct UndeterminedMotion {
  bool rotation = false;                                ///< about a line; else along it
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< unit vector, frame of the mesh
  Eigen::Vector3d point = Eigen::Vector3d::Zero();      ///< rotation: on the line, mm
  double pitch_mm = 0;  ///< rotation: movement along the line per radian, not zero for a screw
};

/// How far two poses of a scan are from each other beside undetermined motions: zero if a combination of these, of any
/// size, leads from one to the other.
///
/// The undetermined motions of a scan on a surface (turns about an axis, shifts along a plane, turns about a centre)
/// form a group; of the difference, written as one screw, its part in them is taken away until none is left.
/// @param undetermined  in the frame of the mesh
/// @param reference     middle of the scan, frame of the mesh, mm
/// @param extent        lever by which angles become lengths: about the radius of the scan, mm
/// @return mm
double pose_difference(const RigidTransform& mesh_from_scan, const RigidTransform& other,
                       std::span<const UndeterminedMotion> undetermined, const Eigen::Vector3d& reference,
                       double extent);

}  // namespace abbe
