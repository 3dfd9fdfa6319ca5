#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "abbe/instruments/trackers/tracker.h"

namespace abbe {

/// Pose of a station as evaluate() needs it.
struct StationPose {
  Eigen::Matrix3d body_from_tracker = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< of the tracker in the body's frame, mm
  /// Columns: axes in the body's frame about which a change of rx, ry, rz turns the station.
  Eigen::Matrix3d turn_axes = Eigen::Matrix3d::Identity();
};

/// Left Jacobian of a rotation vector: exp(w + dw) = exp(J dw) exp(w) to first order.
/// Source: Chirikjian, Stochastic Models, Information Theory, and Lie Groups 2 (2012), eq. (10.86).
Eigen::Matrix3d rotation_vector_axes(const Eigen::Vector3d& w);

/// Readings of one station that follow each other, as pointers to [count] values.
struct ResidualInput {
  std::size_t count = 0;
  const double* seen[3];      ///< reflector in the frame of the station's body, mm
  const double* measured[3];  ///< as TrackerReadings::measured; polar: only the range is used
  const double* sines[2];     ///< polar: sine of azimuth and elevation measured
  const double* cosines[2];   ///< polar: cosine
  const double* weight[6];    ///< whitening()
};

struct ResidualOutput {
  double* residual[3];  ///< [count], dimensionless
  double* force[3][3];  ///< or null: force[row][x, y, z] in the body's frame: d(whitened modelled row) / d(seen), 1/mm
};

void tracker_residuals(TrackerMeasure measure, const StationPose& station, const ResidualInput& in,
                       const ResidualOutput& out);

}  // namespace abbe
