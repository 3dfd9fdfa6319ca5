#include "abbe/identify/trust/independent_readings.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "abbe/errors/random_stream.h"
#include "abbe/identify/identify.h"
#include "abbe/instruments/ball_bar.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

using Eigen::Index;
using enum Component;

ErrorSet squareness_of(double c, double a, double b) {
  ErrorSet errors;
  errors.locations = {{1, C, c, 0}, {2, A, a, 0}, {2, B, b, 0}};
  return errors;
}

/// Readings of a ball bar whose table ball is unknown, the errors of the machine held.
struct BarReadings {
  Machine machine = parse_chain("w X' Y' b Z t").machine;
  Problem problem;

  BarReadings(const ErrorSet& truth, const ErrorSet& held, std::size_t count, std::uint64_t seed, bool ball_known) {
    BallBarSetup setup;
    setup.balls = {{"table", ball_known ? SetupPoint::exact({0, 0, 0}) : SetupPoint::open({0, 0, 0})}};
    const auto bar = std::make_shared<const BallBar>(setup);
    InstrumentReadings plan;
    RandomStream random(seed, 1);
    for (std::size_t k = 0; k < count; ++k) {
      plan.append({300 * random.uniform(-1, 1), 300 * random.uniform(-1, 1), random.uniform(50, 300)}, 0);
    }
    InstrumentSimulationOptions options;
    options.seed = seed;
    const InstrumentReadings read = simulate_instrument(machine, truth, bar, plan, options).readings;
    problem = estimate_everything(machine, held, {bar->observations(machine, held, read)});
    problem.machine_parameters.clear();
    if (estimated_count(problem) > 0) identify(problem);
  }
};

/// Covariance of the three squareness errors, correlated; the tool offset is exact.
Eigen::MatrixXd correlated(double u) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(6, 6);
  covariance.topLeftCorner(3, 3) << 1, 0.6, 0, 0.6, 2, -0.5, 0, -0.5, 1.5;
  return u * u * covariance;
}

/// The whole Jacobian of the modelled values, [readings, columns], and the residuals.
std::pair<Eigen::MatrixXd, Eigen::VectorXd> dense(const Observations& observations,
                                                  const std::vector<std::size_t>& machine,
                                                  const std::vector<std::size_t>& unknowns) {
  const auto n = static_cast<Index>(observations.reading_count());
  Eigen::MatrixXd jacobian(n, static_cast<Index>(machine.size() + unknowns.size()));
  Eigen::VectorXd residuals(n);
  for (Index k = 0; k < n; ++k) {
    Eigen::VectorXd row(jacobian.cols());
    observations.evaluate(static_cast<std::size_t>(k), 1, machine, unknowns, &residuals[k], row.data(), 1);
    jacobian.row(k) = row;
  }
  return {jacobian, residuals};
}

TEST(IndependentReadings, HaveTheChiSquareAndTheNormsOfDenseMatrices) {
  const ErrorSet truth = squareness_of(30e-6, -20e-6, 50e-6), held = squareness_of(28e-6, -21e-6, 52e-6);
  const BarReadings bar(truth, held, 40, 3, false);
  const Eigen::MatrixXd covariance = correlated(2e-6);
  const IndependentReadings judged = judge_independent_readings(bar.problem, covariance);

  const auto [jacobian, residuals] = dense(*bar.problem.observations[0].observations, {0, 1, 2}, {0, 1, 2});
  const Eigen::MatrixXd by_errors = jacobian.leftCols(3), by_setup = jacobian.rightCols(3);
  const Index n = residuals.size();
  const Eigen::MatrixXd whole =
      Eigen::MatrixXd::Identity(n, n) + by_errors * covariance.topLeftCorner(3, 3) * by_errors.transpose();
  const Eigen::MatrixXd inverse = whole.inverse();
  const Eigen::VectorXd fitted =
      (by_setup.transpose() * inverse * by_setup).inverse() * (by_setup.transpose() * inverse * residuals);
  const Eigen::VectorXd left = residuals - by_setup * fitted;
  EXPECT_NEAR(judged.chi_square, left.dot(inverse * left), 1e-6 * judged.chi_square);
  EXPECT_EQ(judged.degrees_of_freedom, 37);
  EXPECT_EQ(judged.components, 40U);

  const Eigen::MatrixXd hat = by_setup * (by_setup.transpose() * by_setup).inverse() * by_setup.transpose();
  const Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(n, n) - hat;
  const Eigen::MatrixXd spread = rest * whole * rest.transpose();
  for (Index k = 0; k < n; ++k) {
    EXPECT_NEAR(judged.norm[0][static_cast<std::size_t>(k)], std::abs(residuals[k]) / std::sqrt(spread(k, k)), 1e-5);
  }
}

TEST(IndependentReadings, WithoutUncertainErrorsAreThoseOfTheFit) {
  const ErrorSet errors = squareness_of(30e-6, -20e-6, 50e-6);
  const BarReadings known(errors, errors, 25, 5, true);
  const IndependentReadings judged = judge_independent_readings(known.problem, Eigen::MatrixXd::Zero(6, 6));
  double square = 0;
  for (const double r : residuals_by_reading(*known.problem.observations[0].observations)) square += r * r;
  EXPECT_NEAR(judged.chi_square, square, 1e-9 * square);
  EXPECT_EQ(judged.degrees_of_freedom, 25);
  EXPECT_EQ(judged.residuals, 25U);
}

TEST(IndependentReadings, FollowTheirDistribution) {
  // Errors drawn from the covariance that is stated, readings with their noise: chi-square, and a share within 2 u.
  constexpr int kCampaigns = 300;
  const Eigen::MatrixXd covariance = correlated(5e-6);
  const Eigen::MatrixXd root = covariance.topLeftCorner(3, 3).llt().matrixL();
  double sum = 0, degrees = 0;
  std::size_t components = 0, within = 0, unlikely = 0;
  for (int i = 0; i < kCampaigns; ++i) {
    RandomStream random(77, static_cast<std::uint64_t>(i));
    const Eigen::Vector3d off = root * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    const ErrorSet held = squareness_of(30e-6, -20e-6, 50e-6),
                   truth = squareness_of(30e-6 + off[0], -20e-6 + off[1], 50e-6 + off[2]);
    const BarReadings bar(truth, held, 12, 1000 + static_cast<std::uint64_t>(i), false);
    const IndependentReadings judged = judge_independent_readings(bar.problem, covariance);
    sum += judged.chi_square;
    degrees += judged.degrees_of_freedom;
    components += judged.components;
    within += judged.components_within;
    unlikely += judged.p_value < 0.05 ? 1U : 0U;
  }
  EXPECT_NEAR(sum / degrees, 1, 4 * std::sqrt(2 / degrees));
  const double share = static_cast<double>(within) / static_cast<double>(components);
  EXPECT_NEAR(share, 0.9545, 0.012);
  EXPECT_NEAR(static_cast<double>(unlikely), 0.05 * kCampaigns, 4 * std::sqrt(0.05 * 0.95 * kCampaigns));
}

TEST(IndependentReadings, OfAnotherMachineAreUnlikely) {
  const BarReadings bar(squareness_of(60e-6, -20e-6, 50e-6), squareness_of(30e-6, -20e-6, 50e-6), 30, 9, false);
  EXPECT_LT(judge_independent_readings(bar.problem, correlated(2e-6)).p_value, 1e-6);
}

TEST(IndependentReadings, OfWhichTheFitReproducesAllLeaveNothingToJudge) {
  const ErrorSet errors = squareness_of(30e-6, -20e-6, 50e-6);
  const BarReadings bar(errors, errors, 3, 4, false);
  const IndependentReadings judged = judge_independent_readings(bar.problem, correlated(1e-6));
  EXPECT_EQ(judged.degrees_of_freedom, 0);
  EXPECT_EQ(judged.p_value, 1);
  EXPECT_LT(judged.chi_square, 1e-6);
}

}  // namespace
}  // namespace abbe
