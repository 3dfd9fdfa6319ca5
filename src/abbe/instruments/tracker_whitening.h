#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "abbe/instruments/tracker.h"

namespace abbe {

/// Upper triangular W with W^T W = inverse of the covariance, so that W * error has unit covariance.
/// @throws std::invalid_argument if the covariance is not positive definite
Eigen::Matrix3d whitening_matrix(const Eigen::Matrix3d& covariance);

/// Covariance of one reading in the components of its residual: Cartesian x, y, z (mm); or range (mm) and the angles
/// across the beam in azimuth and elevation (rad). From the data where they state it, else from the noise model at the
/// measured point.
Eigen::Matrix3d residual_covariance(const TrackerReadings& readings, const TrackerStation& station,
                                    std::size_t reading);

/// Upper triangles of all readings, w[0..5] = W00, W01, W02, W11, W12, W22, each [count].
/// @throws std::invalid_argument naming the reading
std::array<std::vector<double>, 6> whitening(const TrackerReadings& readings, const TrackerSetup& setup);

}  // namespace abbe
