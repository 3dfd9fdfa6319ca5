#include "abbe/instruments/trackers/tracker_whitening.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/aguado_for_test.h"
#include "abbe/instruments/trackers/tracker_observations.h"
#include "abbe/instruments/trackers/tracker_simulation.h"

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::AguadoCase;

constexpr double kArcsecond = 3.14159265358979323846 / 648000;

/// Exact readings of a known machine, most of them with a steep beam, so that an azimuth and the angle across the beam
/// differ.
TrackerReadings exact_readings(AguadoCase& aguado, TrackerMeasure measure, std::size_t count) {
  aguado.setup.stations[0].body_from_tracker = {rotation_from_vector({0.4, -0.3, 0.8}), Vector3d(300, -200, 150)};
  PoseList poses;
  poses.axis.resize(3);
  RandomStream random(9);
  for (std::size_t i = 0; i < count; ++i) {
    poses.axis[0].push_back(random.uniform(0, 6));
    poses.axis[1].push_back(random.uniform(0, 1400));
    poses.axis[2].push_back(random.uniform(0, 600));
  }
  TrackerSimulationOptions options;
  options.measure = measure;
  options.noise_factor = 0;
  options.choice = SightChoice::cycle;
  options.line_of_sight = false;
  options.threads = 1;
  return simulate_tracker(aguado.machine, aguado.truth, aguado.setup, poses, options).readings;
}

/// Mean of the products of whitened residuals at the truth: the identity if the weights are right.
Matrix3d second_moment(const AguadoCase& aguado, const TrackerReadings& readings) {
  const TrackerObservations observations(aguado.machine, aguado.truth, aguado.setup, readings);
  Matrix3d sum = Matrix3d::Zero();
  constexpr std::size_t kBlock = Observations::kBlockSize;
  std::vector<double> residuals(3 * kBlock);
  for (std::size_t first = 0; first < readings.count(); first += kBlock) {
    const std::size_t count = std::min(kBlock, readings.count() - first);
    observations.evaluate(first, count, {}, {}, residuals.data(), nullptr, 3 * count);
    for (std::size_t k = 0; k < count; ++k) {
      const Vector3d r(residuals[k], residuals[count + k], residuals[2 * count + k]);
      sum += r * r.transpose();
    }
  }
  return sum / static_cast<double>(readings.count());
}

TEST(TrackerWhitening, CorrelatedRangesAndAnglesBecomeIndependentResidualsOfUnitVariance) {
  AguadoCase aguado = test::aguado_case();
  TrackerReadings readings = exact_readings(aguado, TrackerMeasure::range_and_angles, 20000);
  const Vector3d u(0.02, 4 * kArcsecond, 2 * kArcsecond);
  Matrix3d correlation;
  correlation << 1, 0.6, -0.5, 0.6, 1, 0.2, -0.5, 0.2, 1;
  const Matrix3d covariance = u.asDiagonal() * correlation * u.asDiagonal();
  const Matrix3d root = Eigen::LLT<Matrix3d>(correlation).matrixL();
  RandomStream random(10);
  readings.stated = StatedUncertainty::covariance;
  double steepest = 0;
  for (std::size_t k = 0; k < readings.count(); ++k) {
    const Vector3d noise = u.asDiagonal() * (root * Vector3d(random.normal(), random.normal(), random.normal()));
    steepest = std::max(steepest, std::abs(readings.measured[2][k]));
    for (std::size_t c = 0; c < 3; ++c) {
      readings.measured[c][k] += noise[static_cast<int>(c)];
      readings.uncertainty[c].push_back(covariance(static_cast<int>(c), static_cast<int>(c)));
    }
    readings.uncertainty[3].push_back(covariance(0, 1));
    readings.uncertainty[4].push_back(covariance(0, 2));
    readings.uncertainty[5].push_back(covariance(1, 2));
  }
  ASSERT_GT(steepest, 0.8) << "without steep beams the azimuth's factor is not tested";
  // Six standard deviations of the mean of 20,000 squares or products.
  const double tolerance = 6 * std::sqrt(2.0 / 20000);
  EXPECT_LT((second_moment(aguado, readings) - Matrix3d::Identity()).cwiseAbs().maxCoeff(), tolerance);

  // The same readings with their correlations dropped are not independent.
  readings.stated = StatedUncertainty::standard;
  for (std::size_t c = 0; c < 3; ++c) {
    for (double& value : readings.uncertainty[c]) value = std::sqrt(value);
    readings.uncertainty[3 + c].clear();
  }
  const Matrix3d dropped = second_moment(aguado, readings);
  EXPECT_NEAR(dropped(0, 1), 0.6, tolerance);
  EXPECT_NEAR(dropped(0, 2), -0.5, tolerance);
  EXPECT_NEAR(dropped(1, 1), 1, tolerance);
}

TEST(TrackerWhitening, AStatedCovarianceWeighsLikeTheNoiseModelItCameFrom) {
  AguadoCase aguado = test::aguado_case();
  aguado.setup.stations[0].noise = TrackerNoise::range_and_angles(5, 0.5, 1.5);
  for (const TrackerMeasure measure : {TrackerMeasure::cartesian, TrackerMeasure::range_and_angles}) {
    TrackerReadings readings = exact_readings(aguado, measure, 60);
    const auto from_model = whitening(readings, aguado.setup);
    state_uncertainty(aguado.setup, StatedUncertainty::covariance, readings);
    ASSERT_EQ(readings.uncertainty[5].size(), readings.count());
    const auto from_data = whitening(readings, aguado.setup);
    for (std::size_t c = 0; c < 6; ++c) {
      for (std::size_t k = 0; k < readings.count(); ++k) {
        EXPECT_NEAR(from_data[c][k], from_model[c][k], 1e-6 * from_model[0][k]);
      }
    }
    state_uncertainty(aguado.setup, StatedUncertainty::standard, readings);
    EXPECT_TRUE(readings.uncertainty[3].empty());
    const Matrix3d c = reading_covariance(readings, 7);
    readings.stated = StatedUncertainty::none;
    if (measure == TrackerMeasure::cartesian) {
      const Matrix3d model = aguado.setup.stations[0].noise.covariance(readings.point(7));
      EXPECT_LT((c.diagonal() - model.diagonal()).norm(), 1e-12);
      EXPECT_GT(std::abs(model(0, 1)), 1e-7) << "a beam along an axis would not test anything";
    } else {
      // The angle across the beam is the azimuth times the cosine of the elevation.
      EXPECT_NEAR(std::sqrt(c(1, 1)) * std::cos(readings.measured[2][7]), 1.5 * kArcsecond, 1e-12);
      EXPECT_NEAR(std::sqrt(c(2, 2)), 1.5 * kArcsecond, 1e-12);
    }
  }
}

TEST(TrackerWhitening, OnlyPositiveDefiniteCovariancesAreAccepted) {
  Matrix3d c = Vector3d(1, 1e-12, 4e-12).asDiagonal();
  EXPECT_TRUE(is_positive_definite(c));
  c(0, 1) = c(1, 0) = 0.99e-6;
  EXPECT_TRUE(is_positive_definite(c));
  c(0, 1) = c(1, 0) = 1.01e-6;
  EXPECT_FALSE(is_positive_definite(c));
  // Each correlation alone is possible, the three together are not.
  Matrix3d together;
  together << 1, 0.9, 0.9, 0.9, 1, -0.9, 0.9, -0.9, 1;
  EXPECT_FALSE(is_positive_definite(together));
  EXPECT_THROW(whitening_matrix(together), std::invalid_argument);
  EXPECT_FALSE(is_positive_definite(Vector3d(1, 0, 1).asDiagonal()));
  EXPECT_FALSE(is_positive_definite(Vector3d(1, -1, 1).asDiagonal()));
  c(0, 2) = std::nan("");
  EXPECT_FALSE(is_positive_definite(c));
}

TEST(TrackerWhitening, AVerticalBeamHasNoAzimuthToStateAnUncertaintyOf) {
  AguadoCase aguado = test::aguado_case();
  TrackerReadings readings = exact_readings(aguado, TrackerMeasure::range_and_angles, 3);
  aguado.setup.stations[0].noise = TrackerNoise::range_and_angles(5, 0.5, 1.5);
  readings.measured[2][1] = std::acos(0.0);
  EXPECT_THROW(state_uncertainty(aguado.setup, StatedUncertainty::covariance, readings), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
