#include "abbe/instruments/trackers/tracker_whitening.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <stdexcept>

namespace abbe {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {
constexpr double kSmallestPivot = 1e-7;
}  // namespace

bool is_positive_definite(const Matrix3d& c) {
  if (!(c(0, 0) > 0) || !(c(1, 1) > 0) || !(c(2, 2) > 0)) return false;
  const Vector3d u(std::sqrt(c(0, 0)), std::sqrt(c(1, 1)), std::sqrt(c(2, 2)));
  // Cholesky factor of the correlation matrix, written out; a NaN fails every comparison.
  const double xy = c(0, 1) / u[0] / u[1], xz = c(0, 2) / u[0] / u[2], yz = c(1, 2) / u[1] / u[2];
  const double second = 1 - xy * xy;
  if (!(second > kSmallestPivot * kSmallestPivot)) return false;
  const double below = (yz - xy * xz) / std::sqrt(second);
  return 1 - xz * xz - below * below > kSmallestPivot * kSmallestPivot;
}

Matrix3d whitening_matrix(const Matrix3d& covariance) {
  if (!is_positive_definite(covariance)) throw std::invalid_argument("covariance is not positive definite");
  const Vector3d scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix3d correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Matrix3d inverse = Eigen::LLT<Matrix3d>(correlation).solve(Matrix3d::Identity());
  const Eigen::LLT<Matrix3d> inverse_factor(0.5 * (inverse + inverse.transpose()));
  if (inverse_factor.info() != Eigen::Success) throw std::invalid_argument("covariance is not positive definite");
  return Matrix3d(inverse_factor.matrixU()) * scale.asDiagonal();
}

Matrix3d reading_covariance(const TrackerReadings& readings, std::size_t k) {
  Matrix3d covariance = Matrix3d::Zero();
  const std::array<std::vector<double>, 6>& u = readings.uncertainty;
  if (readings.stated == StatedUncertainty::standard) {
    for (int c = 0; c < 3; ++c) covariance(c, c) = std::pow(u[static_cast<std::size_t>(c)][k], 2);
  } else {
    covariance << u[0][k], u[3][k], u[4][k], u[3][k], u[1][k], u[5][k], u[4][k], u[5][k], u[2][k];
  }
  return covariance;
}

TrackerNoise typical_noise(const TrackerReadings& readings) {
  const TrackerStation without_noise;
  Vector3d mean = Vector3d::Zero();
  for (std::size_t k = 0; k < readings.count(); ++k) {
    mean += residual_covariance(readings, without_noise, k).diagonal() / static_cast<double>(readings.count());
  }
  if (readings.measure == TrackerMeasure::cartesian) return TrackerNoise::isotropic(1e3 * std::sqrt(mean.mean()), 0);
  return {1e3 * std::sqrt(mean[0]), 0, 0, 1e6 * std::sqrt((mean[1] + mean[2]) / 2)};
}

void state_uncertainty(const TrackerSetup& setup, StatedUncertainty stated, TrackerReadings& readings) {
  readings.stated = StatedUncertainty::none;
  readings.uncertainty = {};
  if (stated == StatedUncertainty::none) return;
  const std::size_t components = stated == StatedUncertainty::standard ? 3 : 6;
  std::array<std::vector<double>, 6> values;
  for (std::size_t c = 0; c < components; ++c) values[c].resize(readings.count());
  for (std::size_t k = 0; k < readings.count(); ++k) {
    Matrix3d covariance = residual_covariance(readings, setup.stations[readings.station[k]], k);
    if (readings.measure == TrackerMeasure::range_and_angles) {
      const double across = std::cos(readings.measured[2][k]);
      if (!(std::abs(across) > kVerticalBeam)) {
        throw std::invalid_argument("reading " + std::to_string(k) + ": a vertical beam has no azimuth");
      }
      const Vector3d azimuth(1, 1 / across, 1);
      covariance = azimuth.asDiagonal() * covariance * azimuth.asDiagonal();
    }
    static constexpr int kElements[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (std::size_t c = 0; c < components; ++c) {
      const double element = covariance(kElements[c][0], kElements[c][1]);
      values[c][k] = stated == StatedUncertainty::standard ? std::sqrt(element) : element;
    }
  }
  readings.stated = stated;
  readings.uncertainty = std::move(values);
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
  Matrix3d covariance = reading_covariance(readings, k);
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
