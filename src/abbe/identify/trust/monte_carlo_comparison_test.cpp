#include "abbe/identify/trust/monte_carlo_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/errors/random_stream.h"
#include "abbe/identify/function_observations_test.h"

namespace abbe {
namespace {

using Complex = FunctionObservations::Complex;

Complex straight_line(std::size_t k, std::size_t, const std::vector<Complex>& b) {
  return b[0] + b[1] * (static_cast<double>(k) / 10);
}

Complex decay(std::size_t k, std::size_t, const std::vector<Complex>& b) {
  return b[0] * std::exp(-b[1] * (static_cast<double>(k) / 10));
}

/// A model of two unknowns fitted to 20 readings, and its simulation.
struct Simulated {
  FunctionObservations observations;
  Problem problem;
  Identification identification;

  Simulated(Complex (*model)(std::size_t, std::size_t, const std::vector<Complex>&), double noise)
      : observations(2, 1, readings(model, noise), noise, model) {
    observations.start({1, 1});
    problem = function_problem({&observations});
    identification = identify(problem);
  }
  static std::vector<double> readings(Complex (*model)(std::size_t, std::size_t, const std::vector<Complex>&),
                                      double noise) {
    RandomStream random(11);
    std::vector<double> data;
    for (std::size_t k = 0; k < 20; ++k) data.push_back(model(k, 0, {2, 0.5}).real() + noise * random.normal());
    return data;
  }
  MonteCarloResult simulate(std::uint64_t seed, std::size_t samples, int chord_iterations = 1) const {
    MonteCarloOptions options;
    options.samples = samples;
    options.seed = seed;
    options.threads = 1;
    options.chord_iterations = chord_iterations;
    return monte_carlo(problem, identification, options);
  }
};

TEST(MonteCarloComparison, a_linear_model_is_said_to_disagree_as_seldom_as_stated) {
  const Simulated line(straight_line, 0.1);
  int disagreements = 0;
  constexpr int kCampaigns = 300;
  for (int i = 0; i < kCampaigns; ++i) {
    const MonteCarloResult simulated = line.simulate(static_cast<std::uint64_t>(i) + 1, 100);
    disagreements += compare_with_covariance(line.identification, simulated, 0.3).agrees() ? 0 : 1;
  }
  // At most 30 % by Bonferroni; the correlation of the two unknowns makes it less, but not nothing.
  EXPECT_LT(disagreements, 0.35 * kCampaigns);
  EXPECT_GT(disagreements, 0.10 * kCampaigns);
}

TEST(MonteCarloComparison, limits_are_those_of_the_chi_square_and_normal_distributions) {
  const Simulated line(straight_line, 0.1);
  const MonteCarloComparison comparison = compare_with_covariance(line.identification, line.simulate(1, 1000), 0.08);
  ASSERT_EQ(comparison.parameters.size(), 2u);
  EXPECT_EQ(comparison.samples, 1000u);
  // Tail 0.08 / (4 * 2) = 0.01; Wilson and Hilferty (1931) for the chi-square quantile.
  const auto wilson_hilferty = [](double z) {
    const double n = 999;
    return std::pow(1 - 2 / (9 * n) + z * std::sqrt(2 / (9 * n)), 1.5);
  };
  EXPECT_NEAR(comparison.ratio_high, wilson_hilferty(2.3263479), 1e-5);
  EXPECT_NEAR(comparison.ratio_low, wilson_hilferty(-2.3263479), 1e-5);
  EXPECT_NEAR(comparison.shift_limit, 2.3263479 / std::sqrt(1000.0), 1e-8);
}

TEST(MonteCarloComparison, a_covariance_ten_percent_too_large_is_found) {
  Simulated line(straight_line, 0.1);
  const MonteCarloResult simulated = line.simulate(3, 4000);
  EXPECT_TRUE(compare_with_covariance(line.identification, simulated).agrees());
  line.identification.standard_uncertainties *= 1.1;
  const MonteCarloComparison comparison = compare_with_covariance(line.identification, simulated);
  EXPECT_FALSE(comparison.agrees());
  EXPECT_EQ(comparison.beyond, 2u);
  EXPECT_NEAR(comparison.largest_ratio, 1 / 1.1, 0.03);
}

TEST(MonteCarloComparison, the_shift_of_a_nonlinear_model_is_found) {
  const Simulated curve(decay, 0.5);
  const MonteCarloComparison comparison = compare_with_covariance(curve.identification, curve.simulate(5, 20000, 4));
  EXPECT_FALSE(comparison.agrees());
  EXPECT_GT(comparison.largest_shift, comparison.shift_limit);
}

TEST(MonteCarloComparison, without_a_simulation_or_uncertain_parameters_there_is_no_agreement) {
  Simulated line(straight_line, 0.1);
  EXPECT_FALSE(compare_with_covariance(line.identification, MonteCarloResult()).agrees());
  const MonteCarloResult simulated = line.simulate(1, 50);
  line.identification.standard_uncertainties.setZero();
  EXPECT_FALSE(compare_with_covariance(line.identification, simulated).agrees());
}

}  // namespace
}  // namespace abbe
