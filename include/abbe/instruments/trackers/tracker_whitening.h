#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "abbe/instruments/trackers/tracker.h"

namespace abbe {

/// Cosine of the elevation below which a beam is vertical and has no azimuth.
inline constexpr double kVerticalBeam = 1e-6;

/// True if a covariance can be used: positive variances and a correlation matrix whose Cholesky factor has no pivot
/// below 1e-7. Scaled, so that mm^2 beside rad^2 do not decide what counts as definite.
bool is_positive_definite(const Eigen::Matrix3d& covariance);

/// Upper triangular W with W^T W = inverse of the covariance, so that W * error has unit covariance.
/// @throws std::invalid_argument if the covariance is not positive definite
Eigen::Matrix3d whitening_matrix(const Eigen::Matrix3d& covariance);

/// Covariance of one reading's measured components as the data state it, which has to be `standard` or `covariance`;
/// azimuth as the angle itself.
Eigen::Matrix3d reading_covariance(const TrackerReadings& readings, std::size_t k);

/// States with the readings what their stations' noise model says at the measured points: standard uncertainties (then
/// without the correlations of Cartesian components) or full covariances; `none` takes them away.
/// @throws std::invalid_argument for range and angles of a vertical beam, whose azimuth has no uncertainty
void state_uncertainty(const TrackerSetup& setup, StatedUncertainty stated, TrackerReadings& readings);

/// A noise model of about the size of the uncertainties that the data state, the same for all stations: to weight
/// readings that do not exist yet.
TrackerNoise typical_noise(const TrackerReadings& readings);

/// Covariance of one reading in the components of its residual: Cartesian x, y, z (mm); or range (mm) and the angles
/// across the beam in azimuth and elevation (rad). From the data where they state it, else from the noise model at the
/// measured point.
Eigen::Matrix3d residual_covariance(const TrackerReadings& readings, const TrackerStation& station, std::size_t k);

/// Upper triangles of all readings, w[0..5] = W00, W01, W02, W11, W12, W22, each [count].
/// @throws std::invalid_argument naming the reading
std::array<std::vector<double>, 6> whitening(const TrackerReadings& readings, const TrackerSetup& setup);

}  // namespace abbe
