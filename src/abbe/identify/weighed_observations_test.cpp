#include "abbe/identify/weighed_observations.h"

#include <gtest/gtest.h>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"
#include "abbe/identify/normal_equations.h"
#include "abbe/identify/pose_noise_for_test.h"
#include "abbe/instruments/trackers/tracker_observations.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using test::DenseReadings;
using test::PoseObservations;

TEST(WeighedObservations, sums_are_those_of_the_whole_covariance_matrix) {
  constexpr std::size_t kPoses = 60;
  PoseObservations observations(kPoses, PoseObservations::simulate(3, kPoses, 5, 1, 0.05));  // 300 readings: 3 blocks
  std::vector<std::uint8_t> use(300, 1);
  for (std::size_t k = 0; k < 300; k += 7) use[k] = 0;
  observations.data()[3 * 7] = std::nan("");  // not used
  WeighedObservations weighed(borrowed(observations), use);
  weighed.weigh({1.7, 0.003});
  Problem problem = function_problem({&weighed});
  problem.observations[0].use = use;
  const NormalEquations sums = ReadingStream(problem, 2).sums(present_values(problem), Loss{}, Wanted::normal);

  const DenseReadings dense(observations, use, kPoses);
  const Cholesky factor(dense.covariance(1.7, 0.003));
  const Eigen::MatrixXd solved = factor.solve_columns(dense.jacobian);
  const Eigen::MatrixXd normal = dense.jacobian.transpose() * solved;
  const Eigen::VectorXd gradient = solved.transpose() * dense.residuals;
  EXPECT_LT((sums.normal - normal).norm(), 1e-12 * normal.norm());
  EXPECT_LT((sums.gradient - gradient).norm(), 1e-11 * gradient.norm());
  EXPECT_NEAR(2 * sums.cost / dense.residuals.dot(factor.solve(dense.residuals)), 1, 1e-12);
}

TEST(WeighedObservations, derivatives_are_those_of_the_weighted_residuals) {
  constexpr std::size_t kPoses = 30;
  PoseObservations observations(kPoses, PoseObservations::simulate(4, kPoses, 2, 1, 0.05));
  WeighedObservations weighed(borrowed(observations), {});
  weighed.weigh({0.5, 0.01});
  const std::vector<double> at = weighed.unknown_values();
  const std::vector<std::size_t> columns = {0, 1, 2, 3, 4};
  Eigen::VectorXd residuals(60), low(60), high(60);
  Eigen::MatrixXd jacobian(60, 5);
  weighed.evaluate(10, 20, {}, columns, residuals.data(), jacobian.data(), 60);
  for (const std::size_t i : columns) {
    constexpr double kStep = 1e-4;  // the model is linear in its parameters
    for (const double step : {-kStep, kStep}) {
      std::vector<double> moved = at;
      moved[i] += step;
      weighed.set_parameters({}, moved);
      weighed.evaluate(10, 20, {}, {}, (step < 0 ? low : high).data(), nullptr, 0);
    }
    EXPECT_LT(((low - high) / (2 * kStep) - jacobian.col(static_cast<Eigen::Index>(i))).norm(), 1e-6) << i;
  }
}

TEST(WeighedObservations, without_variances_nothing_changes) {
  PoseObservations observations(20, PoseObservations::simulate(5, 20, 2, 1, 0));
  const WeighedObservations weighed(borrowed(observations), {});
  std::vector<double> as_given(120), residuals(120);
  observations.evaluate(0, 40, {}, {}, as_given.data(), nullptr, 0);
  weighed.evaluate(0, 40, {}, {}, residuals.data(), nullptr, 0);
  EXPECT_EQ(residuals, as_given);
}

TEST(WeighedObservations, a_tracker_sees_a_displacement_as_the_opposite_of_its_own) {
  const Machine machine = test::three_axis_mill();
  TrackerSetup setup;
  TrackerStation station;
  station.name = "S";
  station.estimate_pose = true;
  station.noise = TrackerNoise::isotropic(10, 5);
  station.body_from_tracker = {rotation_from_vector({0.1, -0.2, 0.7}), {900, -700, 300}};
  setup.stations = {station};
  setup.reflectors = {Reflector{.name = "R", .offset = {10, 20, 30}}};
  TrackerReadings readings;
  readings.measure = TrackerMeasure::range_and_angles;
  readings.poses.axis.resize(machine.axes.size());
  for (int k = 0; k < 4; ++k) {
    for (std::vector<double>& axis : readings.poses.axis) axis.push_back(20.0 * k);
    readings.station.push_back(0);
    readings.reflector.push_back(0);
    readings.measured[0].push_back(1200.0 + k);
    readings.measured[1].push_back(2.5 + 0.01 * k);
    readings.measured[2].push_back(-0.2);
  }
  const TrackerObservations observations(machine, ErrorSet{}, setup, readings);
  const std::vector<std::size_t> position = {0, 1, 2};
  std::vector<double> residuals(12), jacobian(36), rows(36);
  observations.evaluate(0, 4, {}, position, residuals.data(), jacobian.data(), 12);
  ASSERT_TRUE(observations.displacement_rows(0, 4, rows.data()));
  for (std::size_t i = 0; i < 36; ++i) EXPECT_DOUBLE_EQ(rows[i], -jacobian[i]) << i;
}

}  // namespace
}  // namespace abbe
