#pragma once

// Internal to geometry.
#include <Eigen/Core>
#include <vector>

#include "abbe/geometry/registration/pose_difference.h"

namespace abbe {

/// Names motions that a scan does not determine: first pure translations, then rotations about lines.
/// @param unseen     [6, k] orthonormal: turns about `reference`, in units of 1 / extent, and shifts, mm
/// @param extent     about the radius of the scan, mm
/// @param reference  middle of the scan, frame of the mesh, mm
std::vector<UndeterminedMotion> undetermined_motions(const Eigen::MatrixXd& unseen, double extent,
                                                     const Eigen::Vector3d& reference);

}  // namespace abbe
