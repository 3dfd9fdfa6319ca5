#pragma once

#include <Eigen/Core>

namespace abbe {

/// Angle between two vectors, rad, [0, pi]; exact to rounding also near 0 and pi. Lengths do not matter.
double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace abbe
