#include "abbe/identify/walk_intensity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/identify/function_observations_test.h"

namespace abbe {
namespace {

constexpr std::size_t kTimes = 30;
constexpr double kNoise = 0.02;

/// Unevenly spaced, s.
double time_at(std::size_t k) { return 10 * static_cast<double>(k + 1) + 4 * std::sin(static_cast<double>(k)); }

/// a + b sin t + W(t) at every time, W(0) = 0; the values of W are unknowns.
std::complex<double> wandering(std::size_t k, std::size_t, const std::vector<std::complex<double>>& b) {
  return b[0] + b[1] * std::sin(0.4 * static_cast<double>(k)) + b[2 + k];
}

std::vector<double> wandering_readings(std::uint64_t seed, double intensity) {
  RandomStream random(seed);
  std::vector<double> data;
  double walk = 0, before = 0;
  for (std::size_t k = 0; k < kTimes; ++k) {
    walk += intensity * std::sqrt(time_at(k) - before) * random.normal();
    before = time_at(k);
    data.push_back(1 + 0.5 * std::sin(0.4 * static_cast<double>(k)) + walk + kNoise * random.normal());
  }
  return data;
}

/// The restricted likelihood without unknowns for the walk: its covariance is min(t_i, t_j) variance.
double dense_likelihood(const std::vector<double>& data, double variance) {
  Eigen::MatrixXd v(kTimes, kTimes), x(kTimes, 2);
  Eigen::VectorXd y(kTimes);
  for (std::size_t i = 0; i < kTimes; ++i) {
    const auto ii = static_cast<Eigen::Index>(i);
    y[ii] = data[i];
    x.row(ii) << 1, std::sin(0.4 * static_cast<double>(i));
    for (std::size_t j = 0; j < kTimes; ++j) {
      v(ii, static_cast<Eigen::Index>(j)) =
          variance * std::min(time_at(i), time_at(j)) + (i == j ? kNoise * kNoise : 0.0);
    }
  }
  const Cholesky factor(v);
  const Eigen::MatrixXd normal = x.transpose() * factor.solve_columns(x);
  const Cholesky normal_factor(normal);
  const Eigen::VectorXd right = x.transpose() * factor.solve(y);
  const Eigen::VectorXd fit = normal_factor.solve(right);
  const Eigen::VectorXd residual = y - x * fit;
  return -factor.diagonal().array().log().sum() - normal_factor.diagonal().array().log().sum() -
         0.5 * residual.dot(factor.solve(residual));
}

/// The most likely intensity by golden sections over its logarithm.
double dense_variance(const std::vector<double>& data) {
  double low = std::log(1e-9), high = std::log(1e-1);
  const double golden = 0.5 * (std::sqrt(5.0) - 1);
  for (int i = 0; i < 80; ++i) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    (dense_likelihood(data, std::exp(a)) > dense_likelihood(data, std::exp(b)) ? high : low) =
        dense_likelihood(data, std::exp(a)) > dense_likelihood(data, std::exp(b)) ? b : a;
  }
  return std::exp(0.5 * (low + high));
}

JointPrior walk_prior(double variance) {
  JointPrior prior;
  const auto n = static_cast<Eigen::Index>(kTimes);
  Eigen::MatrixXd covariance(n, n);
  for (std::size_t i = 0; i < kTimes; ++i) {
    prior.parameters.push_back({0, 2 + i});
    for (std::size_t j = 0; j < kTimes; ++j) {
      covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          variance * std::min(time_at(i), time_at(j));
    }
  }
  prior.value = Eigen::VectorXd::Zero(n);
  prior.information = Cholesky(covariance).solve_columns(Eigen::MatrixXd::Identity(n, n));
  prior.residual_count = static_cast<double>(kTimes);
  return prior;
}

/// The walk as identification finds it, from a start of 1e-6.
EstimatedWalk found_walk(const std::vector<double>& data) {
  FunctionObservations observations(2 + kTimes, 1, data, kNoise, wandering);
  observations.start(std::vector<double>(2 + kTimes, 0.0));
  Problem problem = function_problem({&observations});
  problem.joint_priors = {walk_prior(1e-6)};
  std::vector<EstimatedWalk> walks = {{"walk", 0, false, {0}, 1e-6}};
  const Identification found = identify_with_walks(problem, walks);
  EXPECT_EQ(found.status, IdentifyStatus::converged) << found.message;
  return walks.front();
}

TEST(WalkIntensity, IsTheMostLikelyOneOfWholeMatrices) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const std::vector<double> data = wandering_readings(seed, 0.01);
    const EstimatedWalk walk = found_walk(data);
    EXPECT_NEAR(walk.variance / dense_variance(data), 1, 1e-5) << seed;
    // The information is the curvature of the likelihood in the mean: of the same size in one draw.
    EXPECT_GT(walk.variance_uncertainty, 0.1 * walk.variance);
    EXPECT_LT(walk.variance_uncertainty, walk.variance);
  }
}

TEST(WalkIntensity, OfWhatStandsStillIsZero) {
  std::size_t none = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const EstimatedWalk walk = found_walk(wandering_readings(50 + seed, 0));
    none += walk.at_zero ? 1U : 0U;
    EXPECT_LT(walk.variance, 4 * walk.variance_uncertainty);
  }
  EXPECT_GE(none, 6U);  // half of the draws fall on the side of less than nothing
}

}  // namespace
}  // namespace abbe
