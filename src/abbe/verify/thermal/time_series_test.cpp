#include "abbe/verify/thermal/time_series.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace abbe {
namespace {

TimeSeries random_series(unsigned seed, std::size_t n) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> step(0.05, 3), value(-1, 1);
  TimeSeries series{"X", {}, {}};
  double time = -10;
  for (std::size_t i = 0; i < n; ++i) {
    series.time.push_back(time += step(random));
    series.values.push_back((series.values.empty() ? 0 : 0.8 * series.values.back()) + value(random));
  }
  return series;
}

TEST(TimeSeries, IsAStraightLineBetweenReadings) {
  const TimeSeries series{"X", {0, 10, 30}, {1, 3, -1}};
  EXPECT_EQ(value_at(series, 0), 1);
  EXPECT_EQ(value_at(series, 5), 2);
  EXPECT_EQ(value_at(series, 10), 3);
  EXPECT_EQ(value_at(series, 25), 0);
  EXPECT_EQ(value_at(series, 30), -1);
  EXPECT_DOUBLE_EQ(mean_over_time(series), (10 * 2 + 20 * 1) / 30.0);
  EXPECT_EQ(mean_over_time({"X", {5}, {7}}), 7);
}

TEST(TimeSeries, RangesHaveTheValuesAtTheirEnds) {
  const TimeSeries series{"X", {0, 10, 30}, {1, 3, -1}};
  const SeriesRange whole = range_between(series, 0, 30);
  EXPECT_EQ(whole.value(), 4);
  EXPECT_EQ(whole.low_at, 30);
  EXPECT_EQ(whole.high_at, 10);
  const SeriesRange part = range_between(series, 15, 20);
  EXPECT_EQ(part.high, 2);
  EXPECT_EQ(part.low, 1);
  EXPECT_EQ(range_between(series, 5, 5).value(), 0);
  EXPECT_EQ(longest_gap(series, 0, 30), 20);
  EXPECT_EQ(longest_gap(series, 0, 10), 10);
  EXPECT_EQ(longest_gap(series, 12, 13), 20);
  EXPECT_EQ(longest_gap({"X", {5}, {7}}, 5, 5), 0);
}

TEST(TimeSeries, TheLargestRangeIsThatOfTheWorstOfAllWindows) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const TimeSeries series = random_series(seed, 60);
    for (const double window : {0.3, 2.0, 9.0, series.duration()}) {
      double range = 0, change = 0;
      constexpr int kStarts = 4000;
      for (int i = 0; i <= kStarts; ++i) {
        const double from = series.from() + (series.duration() - window) * i / kStarts;
        const double to = std::min(from + window, series.to());
        range = std::max(range, range_between(series, from, to).value());
        change = std::max(change, std::abs(value_at(series, to) - value_at(series, from)));
      }
      EXPECT_GE(largest_range_within(series, window), range - 1e-12) << seed << ' ' << window;
      EXPECT_NEAR(largest_range_within(series, window), range, 0.15) << seed << ' ' << window;
      EXPECT_GE(largest_change_over(series, window), change - 1e-12) << seed << ' ' << window;
      EXPECT_NEAR(largest_change_over(series, window), change, 0.15) << seed << ' ' << window;
    }
  }
}

TEST(TimeSeries, AWindowThatRoundingMakesLongerThanTheReadingsIsTheWhole) {
  const TimeSeries series{"X", {0.1 * 3, 0.1 * 3 + 3600 - 1e-9}, {1, 4}};
  EXPECT_NEAR(largest_range_within(series, 3600), 3, 1e-9);
  EXPECT_NEAR(largest_change_over(series, 3600), 3, 1e-9);
}

TEST(TimeSeries, TheDifferenceIsThatAtCommonTimes) {
  const TimeSeries difference = difference_of({"a", {0, 1, 2, 4}, {5, 6, 7, 8}}, {"b", {1, 3, 4}, {1, 1, 3}}, "d");
  EXPECT_EQ(difference.name, "d");
  EXPECT_EQ(difference.time, (std::vector<double>{1, 4}));
  EXPECT_EQ(difference.values, (std::vector<double>{5, 5}));
}

}  // namespace
}  // namespace abbe
