#include <gtest/gtest.h>

#include <cmath>

#include "abbe/errors/random_stream.h"
#include "abbe/identify/decay_wave_and_line_for_test.h"
#include "abbe/identify/function_observations_test.h"
#include "abbe/identify/trust/monte_carlo_comparison.h"

namespace abbe {
namespace {

using Complex = FunctionObservations::Complex;
constexpr double kNoise = 0.01;

Complex at_40ths(std::size_t k, std::size_t row, const std::vector<Complex>& b) {
  return test::decay_wave_and_line(static_cast<double>(k) / 40, row, b);
}

std::vector<double> readings(std::uint64_t seed, double outlier_share = 0) {
  RandomStream random(seed);
  const std::vector<Complex> truth(test::kDecayWaveAndLine.begin(), test::kDecayWaveAndLine.end());
  std::vector<double> data;
  for (std::size_t k = 0; k < 200; ++k) {
    const double shift = random.uniform() < outlier_share ? 60 * kNoise : 0;
    for (std::size_t r = 0; r < 3; ++r)
      data.push_back(at_40ths(k, r, truth).real() + kNoise * random.normal() + shift * random.uniform(-1, 1));
  }
  return data;
}

struct Fitted {
  FunctionObservations observations;
  Problem problem;
  Identification identification;

  Fitted(std::vector<double> data, LossKind loss, double prior_uncertainty = 0)
      : observations(7, 3, std::move(data), kNoise, at_40ths) {
    observations.start({2.5, 0.3, 0.8, 1.5, 1.2, -0.5, 0.3});
    problem = function_problem({&observations});
    if (prior_uncertainty > 0) {
      problem.priors.push_back({estimated_parameters(problem)[0].id, test::kDecayWaveAndLine[0], prior_uncertainty});
    }
    IdentifyOptions options;
    options.loss = loss;
    identification = identify(problem, options);
  }
  MonteCarloResult simulate(LossKind loss, std::size_t samples, std::uint64_t seed = 1, int threads = 1) const {
    MonteCarloOptions options;
    options.samples = samples;
    options.seed = seed;
    options.threads = threads;
    options.loss = loss;
    return monte_carlo(problem, identification, options);
  }
};

TEST(RobustMonteCarlo, agrees_with_the_covariance_on_clean_readings) {
  for (const LossKind loss : {LossKind::huber, LossKind::cauchy, LossKind::tukey}) {
    const Fitted fitted(readings(3), loss);
    ASSERT_EQ(fitted.identification.status, IdentifyStatus::converged);
    const MonteCarloResult simulated = fitted.simulate(loss, 2500);
    EXPECT_EQ(simulated.not_settled, 0u);
    const MonteCarloComparison comparison = compare_with_covariance(fitted.identification, simulated);
    EXPECT_TRUE(comparison.agrees()) << static_cast<int>(loss) << " " << comparison.smallest_ratio << " "
                                     << comparison.largest_ratio << " " << comparison.largest_shift;
    // Least squares repeated for a robust estimate is more certain than that: the test would see it.
    const MonteCarloResult squares = fitted.simulate(LossKind::none, 2500);
    double robust = 0, plain = 0;
    for (Eigen::Index i = 0; i < 7; ++i) {
      robust += simulated.covariance(i, i) / fitted.identification.covariance(i, i) / 7;
      plain += squares.covariance(i, i) / fitted.identification.covariance(i, i) / 7;
    }
    // Standard deviation of these means: at most that of one variance, sqrt(2 / 2500) = 2.8 %.
    EXPECT_NEAR(robust, 1, 0.04);
    EXPECT_NEAR(plain / robust, 0.95, 0.03);  // the same noise: their ratio varies less
  }
}

TEST(RobustMonteCarlo, agrees_with_identifying_simulated_readings_again) {
  const Fitted fitted(readings(3), LossKind::tukey);
  const MonteCarloResult simulated = fitted.simulate(LossKind::tukey, 1500);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(7), square = sum;
  constexpr int kRepetitions = 150;
  for (int i = 0; i < kRepetitions; ++i) {
    const Fitted one(readings(static_cast<std::uint64_t>(i) + 100), LossKind::tukey);
    ASSERT_EQ(one.identification.status, IdentifyStatus::converged);
    sum += one.identification.estimates;
    square += one.identification.estimates.cwiseAbs2();
  }
  // Standard deviation of a standard deviation from 150: 5.8 %.
  for (Eigen::Index i = 0; i < 7; ++i) {
    const double mean = sum[i] / kRepetitions, spread = std::sqrt(square[i] / kRepetitions - mean * mean);
    EXPECT_NEAR(std::sqrt(simulated.covariance(i, i)) / spread, 1, 0.2) << i;
  }
}

TEST(RobustMonteCarlo, repeats_the_outliers_that_were_found) {
  const Fitted fitted(readings(5, 0.25), LossKind::tukey);
  ASSERT_EQ(fitted.identification.status, IdentifyStatus::converged);
  ASSERT_GT(fitted.identification.outliers.size(), 30u);
  const MonteCarloResult simulated = fitted.simulate(LossKind::tukey, 3000);
  double mean = 0;
  for (Eigen::Index i = 0; i < 7; ++i)
    mean += std::sqrt(simulated.covariance(i, i)) / fitted.identification.standard_uncertainties[i] / 7;
  // Which readings are lost matters to single parameters by sqrt(1 / readings of weight); in the mean it does not.
  EXPECT_NEAR(mean, 1, 0.04);
  // Least squares of the same samples knows nothing of outliers and states the uncertainty of clean readings.
  const MonteCarloResult clean = fitted.simulate(LossKind::none, 1000);
  EXPECT_LT(clean.covariance(0, 0), 0.85 * simulated.covariance(0, 0));
}

TEST(RobustMonteCarlo, a_prior_keeps_its_weight) {
  // A prior as good as the readings: half of the information is touched by the loss and half is not.
  const Fitted free(readings(7), LossKind::huber);
  const double u = free.identification.standard_uncertainties[0];
  const Fitted fitted(readings(7), LossKind::huber, u);
  const MonteCarloComparison comparison =
      compare_with_covariance(fitted.identification, fitted.simulate(LossKind::huber, 4000));
  EXPECT_TRUE(comparison.agrees()) << comparison.smallest_ratio << " " << comparison.largest_ratio;
  const Fitted certain(readings(7), LossKind::huber, 1e-4 * u);
  EXPECT_NEAR(certain.identification.standard_uncertainties[0] / (1e-4 * u), 1, 1e-6);
}

TEST(RobustMonteCarlo, does_not_depend_on_the_number_of_threads) {
  const Fitted fitted(readings(5, 0.1), LossKind::cauchy);
  const MonteCarloResult one = fitted.simulate(LossKind::cauchy, 200, 2, 1);
  const MonteCarloResult three = fitted.simulate(LossKind::cauchy, 200, 2, 3);
  EXPECT_EQ(one.covariance, three.covariance);
  EXPECT_EQ(one.percentiles, three.percentiles);
}

}  // namespace
}  // namespace abbe
