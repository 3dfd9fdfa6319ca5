#include "abbe/instruments/tracker_whitening.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <stdexcept>

namespace abbe {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d whitening_matrix(const Matrix3d& covariance) {
  // Scaled, so that mm^2 beside rad^2 do not decide what counts as definite.
  const Vector3d u = covariance.diagonal().cwiseSqrt();
  if (!(u.array() > 0).all() || !u.allFinite()) throw std::invalid_argument("covariance without positive variances");
  const Vector3d scale = u.cwiseInverse();
  const Matrix3d correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::LLT<Matrix3d> factor(correlation);
  if (factor.info() != Eigen::Success || factor.matrixLLT().diagonal().minCoeff() < 1e-7) {
    throw std::invalid_argument("covariance is not positive definite");
  }
  const Matrix3d inverse = factor.solve(Matrix3d::Identity());
  const Eigen::LLT<Matrix3d> inverse_factor(0.5 * (inverse + inverse.transpose()));
  if (inverse_factor.info() != Eigen::Success) throw std::invalid_argument("covariance is not positive definite");
  return Matrix3d(inverse_factor.matrixU()) * scale.asDiagonal();
}

Matrix3d residual_covariance(const TrackerReadings& readings, const TrackerStation& station, std::size_t k) {
  const bool polar = readings.measure == TrackerMeasure::range_and_angles;
  if (readings.stated == StatedUncertainty::none) {
    const Vector3d point = readings.point(k);
    if (!polar) return station.noise.covariance(point);
    const double range = readings.measured[0][k];
    const double along = station.noise.range_uncertainty(range);
    const double angle = station.noise.transverse_uncertainty(range) / range;
    return Vector3d(along * along, angle * angle, angle * angle).asDiagonal();
  }
  Matrix3d covariance = Matrix3d::Zero();
  const std::array<std::vector<double>, 6>& u = readings.uncertainty;
  if (readings.stated == StatedUncertainty::standard) {
    for (int c = 0; c < 3; ++c) covariance(c, c) = std::pow(u[static_cast<std::size_t>(c)][k], 2);
  } else {
    covariance << u[0][k], u[3][k], u[4][k], u[3][k], u[1][k], u[5][k], u[4][k], u[5][k], u[2][k];
  }
  if (polar) {
    // The data speak of the azimuth itself; the residual is the angle across the beam.
    const Vector3d across(1, std::cos(readings.measured[2][k]), 1);
    covariance = across.asDiagonal() * covariance * across.asDiagonal();
  }
  return covariance;
}

std::array<std::vector<double>, 6> whitening(const TrackerReadings& readings, const TrackerSetup& setup) {
  std::array<std::vector<double>, 6> w;
  for (std::vector<double>& values : w) values.resize(readings.count());
  for (std::size_t k = 0; k < readings.count(); ++k) {
    Matrix3d matrix;
    try {
      matrix = whitening_matrix(residual_covariance(readings, setup.stations[readings.station[k]], k));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("reading " + std::to_string(k) + ": " + error.what());
    }
    w[0][k] = matrix(0, 0);
    w[1][k] = matrix(0, 1);
    w[2][k] = matrix(0, 2);
    w[3][k] = matrix(1, 1);
    w[4][k] = matrix(1, 2);
    w[5][k] = matrix(2, 2);
  }
  return w;
}

}  // namespace abbe
