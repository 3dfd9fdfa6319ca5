#include "abbe/verify/evaluations/positioning_uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace abbe {
namespace {

/// `runs` readings of a perfect axis from both sides at 0 and at `length`.
PositioningEvaluation perfect_axis(double length, int runs) {
  std::vector<PositioningReading> readings;
  for (int run = 0; run < runs; ++run) {
    for (const double target : {0.0, length}) {
      readings.push_back({target, 0, ApproachDirection::positive});
      readings.push_back({target, 0, ApproachDirection::negative});
    }
  }
  return evaluate_positioning(readings);
}

TEST(PositioningUncertainty, ContributionsAreThoseWorkedByHand) {
  PositioningUncertaintyInput input;
  input.instrument = 0.0004;
  input.instrument_per_length = 0.6e-6;
  input.misalignment_range = 1;
  input.machine_expansion = 12e-6;
  input.machine_temperature_range = 0.7;
  input.machine_expansion_range = 2e-6;
  input.temperature_from_20_C = -5;
  const PositioningUncertainty u = positioning_uncertainty(input, perfect_axis(1000, 5), false);
  ASSERT_EQ(u.contributions.size(), 4U);
  EXPECT_EQ(u.contributions[0].name, "instrument");
  EXPECT_NEAR(u.contributions[0].expanded, 0.001, 1e-15);
  // 1 mm^2 / (2 * 1000 mm) / sqrt 3 = 0.29 um, the 0.3 R^2 / L of the simplified equations.
  EXPECT_NEAR(u.contributions[1].expanded, 0.000288675, 1e-9);
  EXPECT_NEAR(u.contributions[2].expanded, 0.7 / std::sqrt(3) * 12e-6 * 1000, 1e-15);
  EXPECT_NEAR(u.contributions[3].expanded, 2e-6 / std::sqrt(3) * 5 * 1000, 1e-15);
  double sum = 0;
  for (const auto& contribution : u.contributions) sum += contribution.expanded * contribution.expanded;
  EXPECT_NEAR(u.systematic, std::sqrt(sum), 1e-15);
  EXPECT_NEAR(u.accuracy, std::sqrt(sum), 1e-15);
  EXPECT_NEAR(u.mean_bidirectional, std::sqrt(sum), 1e-15);
  EXPECT_EQ(u.repeatability, 0) << "what stays the same during a test does not act on repeatability";
  EXPECT_EQ(u.reversal, 0);
}

TEST(PositioningUncertainty, LengthsDoNotActOnARotaryAxis) {
  PositioningUncertaintyInput input;
  input.instrument_per_length = 1e-6;
  input.misalignment_range = 1;
  input.machine_expansion = 12e-6;
  input.machine_temperature_range = 1;
  EXPECT_EQ(positioning_uncertainty(input, perfect_axis(6, 5), true).accuracy, 0);
  input.instrument = 5e-6;
  EXPECT_EQ(positioning_uncertainty(input, perfect_axis(6, 5), true).accuracy, 5e-6);
}

TEST(PositioningUncertainty, IsEmptyUntilSomethingIsStated) {
  PositioningUncertaintyInput input;
  EXPECT_TRUE(input.is_empty());
  input.machine_expansion = 12e-6;
  EXPECT_TRUE(input.is_empty()) << "a coefficient without a temperature contributes nothing";
  input.environmental_variation = 1;
  EXPECT_FALSE(input.is_empty());
}

/// The claims about the environment, tried out: a perfect axis read with a drift of known range.
TEST(PositioningUncertainty, OfTheEnvironmentCoversWhatAPerfectAxisWouldShow) {
  PositioningUncertaintyInput input;
  input.environmental_variation = 0.003;
  constexpr int kRuns = 5, kTests = 2000;
  const PositioningUncertainty u = positioning_uncertainty(input, perfect_axis(1000, kRuns), false);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> drift(-0.0015, 0.0015);
  double squares_of_reversal = 0, squares_of_mean = 0, squares_of_end = 0, mean_repeatability = 0;
  for (int test = 0; test < kTests; ++test) {
    std::vector<PositioningReading> readings;
    for (int run = 0; run < kRuns; ++run) {
      for (const double target : {0.0, 1000.0}) {
        readings.push_back({target, drift(random), ApproachDirection::positive});
        readings.push_back({target, drift(random), ApproachDirection::negative});
      }
    }
    const PositioningEvaluation e = evaluate_positioning(readings);
    const auto& first = e.targets[0];
    const auto& last = e.targets[1];
    squares_of_reversal += first.reversal.value * first.reversal.value;
    const double mean = last.mean_bidirectional.value - first.mean_bidirectional.value;
    squares_of_mean += mean * mean;
    const double end = last.mean[0] - first.mean[0];
    squares_of_end += end * end;
    mean_repeatability += first.repeatability[0].value / kTests;
  }
  // k = 2: twice the standard deviation found. 2000 tests give it to 2 %.
  EXPECT_NEAR(2 * std::sqrt(squares_of_reversal / kTests), u.reversal, 0.06 * u.reversal);
  EXPECT_NEAR(2 * std::sqrt(squares_of_mean / kTests), u.mean_bidirectional, 0.06 * u.mean_bidirectional);
  EXPECT_NEAR(2 * std::sqrt(squares_of_end / kTests), u.systematic, 0.06 * u.systematic);
  // The repeatability that a perfect axis would be credited with is the bound 4 u = 2 U.
  EXPECT_NEAR(mean_repeatability, u.unidirectional_repeatability, 0.06 * u.unidirectional_repeatability);
}

}  // namespace
}  // namespace abbe
