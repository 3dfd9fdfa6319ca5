#include "abbe/verify/evaluations/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "abbe/verify/evaluations/values_at_places.h"

namespace abbe {
namespace {

TEST(Statistics, AgreeWithNumbersWorkedByHand) {
  const std::vector<double> values{4, 1, 3, 2, 10};
  const SampleStatistics s = sample_statistics(values);
  EXPECT_EQ(s.count, 5u);
  EXPECT_DOUBLE_EQ(s.mean, 4);
  EXPECT_DOUBLE_EQ(s.rms, std::sqrt(26.0));
  EXPECT_DOUBLE_EQ(s.deviation, std::sqrt(12.5));
  EXPECT_EQ(s.maximum, 10);
  EXPECT_EQ(s.maximum_at, 4u);
  EXPECT_EQ(s.minimum, 1);
  EXPECT_EQ(s.median, 3);
  // Type 7: place 0.9 * 4 = 3.6 between 4 and 10.
  EXPECT_DOUBLE_EQ(s.p90, 7.6);
  EXPECT_DOUBLE_EQ(percentile(values, 0.25), 2);
  EXPECT_DOUBLE_EQ(percentile(values, 1), 10);
}

TEST(Statistics, PercentilesOfOneToAThousandAreExact) {
  std::vector<double> values;
  for (int i = 0; i < 1001; ++i) values.push_back((i * 577) % 1001);
  const SampleStatistics s = sample_statistics(values);
  EXPECT_DOUBLE_EQ(s.median, 500);
  EXPECT_DOUBLE_EQ(s.p90, 900);
  EXPECT_DOUBLE_EQ(s.p95, 950);
  EXPECT_DOUBLE_EQ(s.p99, 990);
  EXPECT_DOUBLE_EQ(percentile(values, 0.123), 123);
}

TEST(Statistics, PercentilesOfManyValuesAreThoseOfAllInOrder) {
  // Both signs, zeros, equal values, values far apart, and values that only their last bits tell apart.
  std::vector<double> values;
  std::uint64_t state = 1;
  for (int i = 0; i < 60000; ++i) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    const double draw = static_cast<double>(state >> 11U) * 0x1p-53 - 0.5;
    values.push_back(i % 7 == 0    ? 0.25
                     : i % 11 == 0 ? 0
                     : i % 13 == 0 ? 1e9 * draw
                     : i % 5 == 0  ? 1 + 1e-12 * draw
                                   : draw);
  }
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const std::vector<std::size_t> places = {59999, 0, 30000, 30000, 12345, 12346, 47000};
  const std::vector<double> found = values_at_places(values, places);
  for (std::size_t k = 0; k < places.size(); ++k) EXPECT_EQ(found[k], sorted[places[k]]) << places[k];
  const std::vector<double> fractions = {0.05, 0.123, 1};
  std::vector<double> percentiles(3);
  const SampleStatistics s = sample_statistics(values, fractions, percentiles);
  const auto expected = [&](double fraction) {
    const double place = fraction * 59999, share = place - std::floor(place);
    const auto below = static_cast<std::size_t>(place);
    return sorted[below] + share * (sorted[std::min<std::size_t>(below + 1, 59999)] - sorted[below]);
  };
  EXPECT_EQ(s.median, expected(0.5));
  EXPECT_EQ(s.p99, expected(0.99));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(percentiles[k], expected(fractions[k])) << fractions[k];
  EXPECT_EQ(percentile(values, 0.123), percentiles[1]);
}

TEST(Statistics, LeaveOutWhatIsNotCoveredAndSayHowMany) {
  const std::vector<double> values{1, 1e9, 3};
  const std::vector<std::uint8_t> covered{1, 0, 1};
  const SampleStatistics s = sample_statistics(values, covered);
  EXPECT_EQ(s.excluded, 1u);
  EXPECT_EQ(s.maximum, 3);
  EXPECT_EQ(s.maximum_at, 2u);
  EXPECT_EQ(sample_statistics({}).count, 0u);
  EXPECT_EQ(sample_statistics(values, std::vector<std::uint8_t>(3, 0)).maximum, 0);
}

TEST(Statistics, SmallSpreadOfLargeValuesKeepsItsDigits) {
  EXPECT_NEAR(sample_statistics(std::vector<double>{1e9 + 1, 1e9 + 2, 1e9 + 3}).deviation, 1, 1e-6);
}

TEST(Statistics, HistogramCountsEveryValueOnce) {
  const std::vector<double> values{0, 0.5, 1, 1.5, 2, -1, 7};
  const Histogram h = histogram(values, 0, 2, 2);
  EXPECT_EQ(h.counts, (std::vector<std::size_t>{2, 3}));
  EXPECT_EQ(h.below, 1u);
  EXPECT_EQ(h.above, 1u);
  EXPECT_EQ(h.width, 1);
}

}  // namespace
}  // namespace abbe
