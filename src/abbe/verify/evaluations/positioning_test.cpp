#include "abbe/verify/evaluations/positioning.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace abbe {
namespace {

constexpr ApproachDirection kUp = ApproachDirection::positive, kDown = ApproachDirection::negative;

/// Two targets, two runs, worked by hand. s of a pair {a, b} is |a - b| / sqrt(2).
///   at 0:   up 1, 3 (mean 2, s sqrt 2)     down -1, -1 (mean -1, s 0)    B = 3
///   at 100: up 4, 4 (mean 4, s 0)          down 5, 7 (mean 6, s sqrt 2)  B = -2
std::vector<PositioningReading> by_hand() {
  return {{0, 1, kUp}, {100, 4, kUp}, {100, 5, kDown}, {0, -1, kDown},
          {0, 3, kUp}, {100, 4, kUp}, {100, 7, kDown}, {0, -1, kDown}};
}

TEST(Positioning, FiguresOfASmallCaseAreThoseWorkedByHand) {
  const PositioningEvaluation e = evaluate_positioning(by_hand());
  const double s = std::sqrt(2.0);
  ASSERT_EQ(e.targets.size(), 2U);
  EXPECT_EQ(e.targets[0].mean[0], 2);
  EXPECT_DOUBLE_EQ(e.targets[0].deviation[0], s);
  EXPECT_EQ(e.targets[0].reversal.value, 3);
  EXPECT_EQ(e.targets[1].reversal.value, -2);
  EXPECT_EQ(e.reversal.value, 3);
  EXPECT_EQ(e.reversal_at, 0U);
  EXPECT_EQ(e.mean_reversal.value, 0.5);
  // Mean bidirectional 0.5 and 5.
  EXPECT_EQ(e.mean_bidirectional.figure.value, 4.5);
  // Means 2, -1, 4, 6.
  EXPECT_EQ(e.systematic.figure.value, 7);
  EXPECT_EQ(e.systematic.low_at, 0U);
  EXPECT_EQ(e.systematic.high_at, 1U);
  EXPECT_EQ(e.unidirectional_systematic[0].figure.value, 2);
  EXPECT_EQ(e.unidirectional_systematic[1].figure.value, 7);
  // Up: 2 +- 2 sqrt 2 and 4; down: -1 and 6 +- 2 sqrt 2.
  EXPECT_DOUBLE_EQ(e.unidirectional_accuracy[0].figure.value, 4 * s);
  EXPECT_DOUBLE_EQ(e.unidirectional_accuracy[1].figure.value, 7 + 2 * s);
  EXPECT_DOUBLE_EQ(e.accuracy.figure.value, 7 + 2 * s);
  EXPECT_DOUBLE_EQ(e.unidirectional_repeatability[0].value, 4 * s);
  EXPECT_DOUBLE_EQ(e.unidirectional_repeatability[1].value, 4 * s);
  // At 0: 2 s + 3 = 5.83 beats 4 s = 5.66; at 100: 2 s + 2 = 4.83 does not.
  EXPECT_DOUBLE_EQ(e.targets[0].bidirectional_repeatability.value, 2 * s + 3);
  EXPECT_DOUBLE_EQ(e.targets[1].bidirectional_repeatability.value, 4 * s);
  EXPECT_DOUBLE_EQ(e.repeatability.figure.value, 2 * s + 3);
  EXPECT_EQ(e.repeatability.low_at, 0U);
  EXPECT_DOUBLE_EQ(e.repeatability.high, 2 + 2 * s);
  EXPECT_DOUBLE_EQ(e.repeatability.low, -1);
  EXPECT_EQ(e.fewest_runs, 2U);
  EXPECT_EQ(e.most_runs, 2U);
  EXPECT_EQ(e.span(), 100);
}

/// Axis with a slope, a period, reversal and noise; every run is one row of the standard's bidirectional cycle.
std::vector<PositioningReading> simulated(int runs = 5, std::uint32_t seed = 7) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.0006);
  std::vector<PositioningReading> readings;
  for (int run = 0; run < runs; ++run) {
    for (const ApproachDirection direction : {kUp, kDown}) {
      for (int i = 0; i <= 10; ++i) {
        const double x = 7.3 + 98.6 * i, side = direction == kUp ? 0.0011 : -0.0011;
        readings.push_back({x, 1.2e-5 * x + 0.002 * std::sin(x / 130) + side + noise(random), direction});
      }
    }
  }
  return readings;
}

/// The definitions written down once more, by another way: per figure a pass over all readings.
struct Independent {
  double a = 0, e = 0, r = 0, b = 0, m = 0, b_mean = 0;
};

Independent by_definition(const std::vector<PositioningReading>& readings) {
  std::vector<double> targets;
  for (const PositioningReading& reading : readings) targets.push_back(reading.target);
  std::sort(targets.begin(), targets.end());
  targets.erase(std::unique(targets.begin(), targets.end()), targets.end());
  std::vector<double> means, uppers, lowers, bidirectional, reversals;
  Independent result;
  for (const double x : targets) {
    double mean[2], s[2];
    for (const ApproachDirection direction : {kUp, kDown}) {
      double n = 0, sum = 0, sum_of_pairs = 0;
      for (const PositioningReading& one : readings) {
        if (one.target != x || one.direction != direction) continue;
        ++n;
        sum += one.deviation;
        // Variance from differences of pairs: s^2 = sum over pairs (a - b)^2 / (n (n - 1)).
        for (const PositioningReading& other : readings) {
          if (other.target != x || other.direction != direction) continue;
          sum_of_pairs += (one.deviation - other.deviation) * (one.deviation - other.deviation) / 2;
        }
      }
      const int k = direction == kUp ? 0 : 1;
      mean[k] = sum / n;
      s[k] = std::sqrt(sum_of_pairs / (n * (n - 1)));
      means.push_back(mean[k]);
      uppers.push_back(mean[k] + 2 * s[k]);
      lowers.push_back(mean[k] - 2 * s[k]);
    }
    reversals.push_back(mean[0] - mean[1]);
    bidirectional.push_back(0.5 * (mean[0] + mean[1]));
    result.b = std::max(result.b, std::abs(mean[0] - mean[1]));
    result.b_mean += (mean[0] - mean[1]) / static_cast<double>(targets.size());
    result.r = std::max({result.r, 2 * s[0] + 2 * s[1] + std::abs(mean[0] - mean[1]), 4 * s[0], 4 * s[1]});
  }
  const auto largest = [](const std::vector<double>& v) { return *std::max_element(v.begin(), v.end()); };
  const auto smallest = [](const std::vector<double>& v) { return *std::min_element(v.begin(), v.end()); };
  result.a = largest(uppers) - smallest(lowers);
  result.e = largest(means) - smallest(means);
  result.m = largest(bidirectional) - smallest(bidirectional);
  return result;
}

TEST(Positioning, AgreesWithTheDefinitionsComputedAnotherWay) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const auto readings = simulated(5, seed);
    const PositioningEvaluation e = evaluate_positioning(readings);
    const Independent other = by_definition(readings);
    EXPECT_NEAR(e.accuracy.figure.value, other.a, 1e-14);
    EXPECT_NEAR(e.systematic.figure.value, other.e, 1e-14);
    EXPECT_NEAR(e.repeatability.figure.value, other.r, 1e-14);
    EXPECT_NEAR(e.reversal.value, other.b, 1e-14);
    EXPECT_NEAR(e.mean_bidirectional.figure.value, other.m, 1e-14);
    EXPECT_NEAR(e.mean_reversal.value, other.b_mean, 1e-14);
    EXPECT_NEAR(e.repeatability.high - e.repeatability.low, other.r, 1e-14);
    EXPECT_GE(e.accuracy.figure.value, e.systematic.figure.value);
    EXPECT_GE(e.systematic.figure.value, e.mean_bidirectional.figure.value);
    for (const std::size_t k : {0U, 1U}) {
      EXPECT_GE(e.accuracy.figure.value, e.unidirectional_accuracy[k].figure.value);
      EXPECT_GE(e.systematic.figure.value, e.unidirectional_systematic[k].figure.value);
      EXPECT_GE(e.repeatability.figure.value, e.unidirectional_repeatability[k].value);
    }
  }
}

TEST(Positioning, RepeatabilityIsThatOfOneSideIfItIsWiderThanBoth) {
  // Up -3, 3: s 3 sqrt 2; down 0, 0: s 0, B 0. Then 4 s+ beats 2 s+ + 2 s- + |B| = 2 s+.
  const PositioningEvaluation e = evaluate_positioning({{0, -3, kUp}, {0, 3, kUp}, {0, 0, kDown}, {0, 0, kDown}});
  EXPECT_DOUBLE_EQ(e.repeatability.figure.value, 12 * std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(e.repeatability.low, -6 * std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(e.repeatability.high, 6 * std::sqrt(2.0));
}

TEST(Positioning, AConstantChangesNoFigure) {
  auto readings = simulated();
  const PositioningEvaluation before = evaluate_positioning(readings);
  for (PositioningReading& reading : readings) reading.deviation += 0.125;
  const PositioningEvaluation after = evaluate_positioning(readings);
  EXPECT_NEAR(after.accuracy.figure.value, before.accuracy.figure.value, 1e-14);
  EXPECT_NEAR(after.systematic.figure.value, before.systematic.figure.value, 1e-14);
  EXPECT_NEAR(after.mean_bidirectional.figure.value, before.mean_bidirectional.figure.value, 1e-14);
  EXPECT_NEAR(after.repeatability.figure.value, before.repeatability.figure.value, 1e-14);
  EXPECT_NEAR(after.mean_reversal.value, before.mean_reversal.value, 1e-14);
  EXPECT_NEAR(after.targets[3].mean[1], before.targets[3].mean[1] + 0.125, 1e-14);
}

TEST(Positioning, ExchangingTheDirectionsExchangesTheUnidirectionalFiguresAndTheSignOfReversal) {
  auto readings = simulated();
  const PositioningEvaluation before = evaluate_positioning(readings);
  for (PositioningReading& reading : readings) reading.direction = reading.direction == kUp ? kDown : kUp;
  const PositioningEvaluation after = evaluate_positioning(readings);
  EXPECT_EQ(after.accuracy.figure.value, before.accuracy.figure.value);
  EXPECT_EQ(after.repeatability.figure.value, before.repeatability.figure.value);
  EXPECT_EQ(after.unidirectional_accuracy[0].figure.value, before.unidirectional_accuracy[1].figure.value);
  EXPECT_EQ(after.unidirectional_repeatability[1].value, before.unidirectional_repeatability[0].value);
  EXPECT_EQ(after.mean_reversal.value, -before.mean_reversal.value);
  EXPECT_EQ(after.reversal.value, before.reversal.value);
}

TEST(Positioning, AnotherUnitScalesEveryFigure) {
  auto readings = simulated();
  const PositioningEvaluation before = evaluate_positioning(readings);
  for (PositioningReading& reading : readings) reading.deviation *= 1024;
  const PositioningEvaluation after = evaluate_positioning(readings);
  EXPECT_EQ(after.accuracy.figure.value, 1024 * before.accuracy.figure.value);
  EXPECT_EQ(after.repeatability.figure.value, 1024 * before.repeatability.figure.value);
  EXPECT_EQ(after.mean_reversal.value, 1024 * before.mean_reversal.value);
}

TEST(Positioning, TheOrderOfTargetsDoesNotMatter) {
  auto readings = simulated();
  const PositioningEvaluation before = evaluate_positioning(readings);
  std::stable_sort(readings.begin(), readings.end(),
                   [](const PositioningReading& a, const PositioningReading& b) { return a.target > b.target; });
  const PositioningEvaluation after = evaluate_positioning(readings);
  EXPECT_EQ(after.accuracy.figure.value, before.accuracy.figure.value);
  EXPECT_EQ(after.targets.front().position, before.targets.front().position);
}

TEST(Positioning, ASingleRunHasReversalButNoRepeatability) {
  const PositioningEvaluation e = evaluate_positioning(simulated(1));
  EXPECT_TRUE(e.systematic.figure.is_evaluated());
  EXPECT_TRUE(e.mean_bidirectional.figure.is_evaluated());
  EXPECT_TRUE(e.reversal.is_evaluated());
  EXPECT_EQ(e.accuracy.figure.status, FigureStatus::needs_two_runs);
  EXPECT_EQ(e.unidirectional_accuracy[1].figure.status, FigureStatus::needs_two_runs);
  EXPECT_EQ(e.repeatability.figure.status, FigureStatus::needs_two_runs);
  EXPECT_EQ(e.unidirectional_repeatability[0].status, FigureStatus::needs_two_runs);
  EXPECT_EQ(e.targets[0].repeatability[0].status, FigureStatus::needs_two_runs);
}

TEST(Positioning, OneDirectionHasNoReversal) {
  auto readings = simulated();
  std::erase_if(readings, [](const PositioningReading& reading) { return reading.direction == kDown; });
  const PositioningEvaluation e = evaluate_positioning(readings);
  EXPECT_TRUE(e.unidirectional_accuracy[0].figure.is_evaluated());
  EXPECT_TRUE(e.unidirectional_repeatability[0].is_evaluated());
  EXPECT_EQ(e.unidirectional_accuracy[1].figure.status, FigureStatus::needs_this_direction);
  EXPECT_EQ(e.accuracy.figure.status, FigureStatus::needs_both_directions);
  EXPECT_EQ(e.systematic.figure.status, FigureStatus::needs_both_directions);
  EXPECT_EQ(e.reversal.status, FigureStatus::needs_both_directions);
  EXPECT_EQ(e.mean_bidirectional.figure.status, FigureStatus::needs_both_directions);
}

TEST(Positioning, OneIncompleteTargetWithholdsWhatItWouldHaveDecided) {
  auto readings = simulated();
  std::erase_if(readings, [](const PositioningReading& reading) {
    return reading.direction == kDown && std::abs(reading.target - 7.3) < 1;
  });
  const PositioningEvaluation e = evaluate_positioning(readings);
  EXPECT_EQ(e.reversal.status, FigureStatus::needs_both_directions);
  EXPECT_TRUE(e.targets[1].reversal.is_evaluated());
  EXPECT_TRUE(e.unidirectional_accuracy[0].figure.is_evaluated());
  EXPECT_EQ(e.unidirectional_accuracy[1].figure.status, FigureStatus::needs_this_direction);
}

TEST(Positioning, NothingAndOnePositionHaveNoSpans) {
  EXPECT_EQ(evaluate_positioning({}).accuracy.figure.status, FigureStatus::no_readings);
  EXPECT_EQ(evaluate_positioning({}).reversal.status, FigureStatus::no_readings);
  const PositioningEvaluation e = evaluate_positioning({{5, 1, kUp}, {5, 3, kUp}, {5, 0, kDown}, {5, 0, kDown}});
  EXPECT_EQ(e.accuracy.figure.status, FigureStatus::needs_two_positions);
  EXPECT_EQ(e.mean_bidirectional.figure.status, FigureStatus::needs_two_positions);
  EXPECT_EQ(e.reversal.value, 2);
}

}  // namespace
}  // namespace abbe
