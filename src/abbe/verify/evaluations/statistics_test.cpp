#include "abbe/verify/evaluations/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

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
