#include "abbe/history/trend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "abbe/errors/random_stream.h"

namespace abbe {
namespace {

TEST(Trend, OfTwoValuesIsTheirDifference) {
  const Trend trend = fit_trend({{0, 1, 0.3}, {10, 3, 0.4}});
  EXPECT_DOUBLE_EQ(trend.slope, 0.2);
  EXPECT_DOUBLE_EQ(trend.level, 3);
  EXPECT_NEAR(trend.u_slope, 0.05, 1e-15);
  EXPECT_NEAR(trend.u_level, 0.4, 1e-15);
  EXPECT_FALSE(trend.scatter);
  EXPECT_DOUBLE_EQ(trend.coverage_factor, 2);
  EXPECT_DOUBLE_EQ(trend.expanded_at(5), 2 * trend.u_at(5));
  EXPECT_TRUE(trend.drifts());
  EXPECT_NEAR(trend.u_at(-10), 0.3, 1e-15);  // at the first time, that of the first value
}

// The sums of weighted least squares written out in Python.
TEST(Trend, WithoutScatterIsTheWeightedLine) {
  const Trend trend = fit_trend({{0, 0.0, 0.5}, {100, 0.4, 0.5}, {250, 0.9, 1.0}, {400, 2.1, 0.5}});
  EXPECT_EQ(*trend.scatter, 0);
  EXPECT_NEAR(trend.slope, 0.005263616557734205, 1e-15);
  EXPECT_NEAR(trend.level, 2.032897603485839, 1e-13);
  EXPECT_NEAR(trend.u_slope, std::sqrt(2.832244008714597e-06), 1e-14);
  EXPECT_DOUBLE_EQ(trend.coverage_factor, 2);
}

TEST(Trend, ScatterMakesTheSumOfSquaresItsDegreesOfFreedom) {
  const std::vector<TimedValue> values = {{0, 0, 0.1}, {1, 3, 0.2}, {2, -1, 0.1}, {3, 4, 0.3}, {4, 1, 0.1}};
  const Trend trend = fit_trend(values);
  double squares = 0;
  for (const TimedValue& one : values) {
    const double left = one.value - trend.at(one.time - 4);
    squares += left * left / (one.uncertainty * one.uncertainty + *trend.scatter * *trend.scatter);
  }
  EXPECT_NEAR(squares, 3, 1e-9);
  EXPECT_DOUBLE_EQ(trend.expanded_at(1), trend.coverage_factor * std::hypot(trend.u_at(1), *trend.scatter));
  EXPECT_NEAR(trend.coverage_factor, 3.307, 1e-3);  // Student's t, 95.45 %, 3 degrees of freedom: GUM, table G.2
}

TEST(Trend, CoversTheTruthAsOftenAsItSays) {
  constexpr int kDraws = 4000;
  for (const double scatter : {0.0, 2.0}) {
    int covered = 0, drifts = 0, as_expected = 0;
    for (int draw = 0; draw < kDraws; ++draw) {
      RandomStream random(17, static_cast<std::uint64_t>(draw) + (scatter > 0 ? 100'000 : 0));
      std::vector<TimedValue> values;
      for (int k = 0; k < 8; ++k) {
        const double u = 0.5 + 0.1 * k;
        values.push_back({30.0 * k, 5 + std::hypot(u, scatter) * random.normal(), u});
      }
      const Trend trend = fit_trend(values);
      covered += std::abs(trend.slope) <= trend.coverage_factor * trend.u_slope ? 1 : 0;
      drifts += trend.drifts() ? 1 : 0;
      as_expected += expected_last(values).is_within ? 1 : 0;
    }
    const double share = static_cast<double>(covered) / kDraws;
    EXPECT_GT(share, 0.945) << scatter;  // without a scatter some draws show one, which makes the band wider
    EXPECT_LT(share, 0.985) << scatter;
    EXPECT_EQ(covered + drifts, kDraws);
    EXPECT_GT(static_cast<double>(as_expected) / kDraws, 0.94) << scatter;
  }
}

TEST(Trend, SayWhenALimitMayBeReached) {
  const Trend trend = fit_trend({{0, 0, 0.01}, {100, 1, 0.01}});
  const double u_slope = std::hypot(0.01, 0.01) / 100;
  const std::optional<double> days = time_to_limit(trend, 0.01, 2, 1e4);
  ASSERT_TRUE(days);
  EXPECT_NEAR(0.01 * *days + 2 * std::hypot(0.01, u_slope * *days), 2, 1e-5);
  EXPECT_EQ(time_to_limit(trend, 0.01, 0.02, 1e4), 0.0);
  EXPECT_FALSE(time_to_limit(trend, 0.01, 1e3, 1e4));
}

TEST(Trend, ExpectedFromOneEarlierValueIsThatValue) {
  Expected expected = expected_last({{0, 0, 3}, {5, 9.9, 4}});
  EXPECT_EQ(expected.value, 0);
  EXPECT_DOUBLE_EQ(expected.expanded, 10);
  EXPECT_TRUE(expected.is_within);
  EXPECT_FALSE(expected_last({{0, 0, 3}, {5, 10.1, 4}}).is_within);
  expected = expected_last({{0, 0, 1}, {10, 1, 1}, {20, 2, 1}});
  EXPECT_DOUBLE_EQ(expected.value, 2);
}

TEST(Trend, RefusesWhatIsNone) {
  EXPECT_THROW(fit_trend({{0, 0, 1}}), std::invalid_argument);
  EXPECT_THROW(fit_trend({{0, 0, 1}, {0, 1, 1}}), std::invalid_argument);
  EXPECT_THROW(fit_trend({{0, 0, 1}, {1, 1, 0}}), std::invalid_argument);
  EXPECT_THROW(fit_trend({{1, 0, 1}, {0, 1, 1}}), std::invalid_argument);
  EXPECT_THROW(expected_last({{0, 0, 1}}), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
