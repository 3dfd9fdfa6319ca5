#include "abbe/verify/parts/deviation_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace abbe {
namespace {

TEST(ExactSumOfNumbers, LosesNothing) {
  ExactSum sum;
  for (const double value : {1e20, 1.0, -1e20, 1e-30, 3.0}) sum.add(value);
  EXPECT_EQ(sum.value(), 4.0L + 1e-30L);
  sum.add(-4.0);
  EXPECT_EQ(static_cast<double>(sum.value()), 1e-30);
  sum.add(-2e-30);
  EXPECT_EQ(static_cast<double>(sum.value()), -1e-30);
  ExactSum squares;
  squares.add_square(1 + 0x1p-40);
  squares.add(-1.0);
  squares.add(-0x1p-39);
  EXPECT_EQ(static_cast<double>(squares.value()), 0x1p-80);
}

TEST(FineHistogramOfValues, HasPercentilesWithinTheirBounds) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.01, 0.02);
  std::vector<double> values{0, 1e-12, -1e-9, 1e3};
  for (int i = 0; i < 5000; ++i) values.push_back(normal(random));
  FineHistogram fine;
  std::vector<double> amounts;
  for (const double value : values) {
    fine.add(FineHistogram::class_of(value));
    amounts.push_back(std::abs(value));
  }
  EXPECT_EQ(fine.count(), values.size());
  for (const double fraction : {0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 0.98, 1.0}) {
    const BoundedValue found = fine.percentile(fraction), amount = fine.percentile_of_amounts(fraction);
    EXPECT_LE(std::abs(found.value - percentile(values, fraction)), found.bound) << fraction;
    EXPECT_LE(std::abs(amount.value - percentile(amounts, fraction)), amount.bound) << fraction;
    EXPECT_LE(found.bound, 1e-8 + 4e-5 * std::abs(found.value));
  }
}

TEST(PointSampleOfNumbers, DoesNotDependOnTheOrder) {
  PointSample forwards(50), backwards(50);
  for (std::uint64_t i = 0; i < 3000; ++i) {
    for (const auto& [sample, k] : {std::pair{&forwards, i}, std::pair{&backwards, 2999 - i}}) {
      const double d = std::sin(static_cast<double>(k));
      if (sample->wants(k, d)) sample->add({k, Eigen::Vector3d::Zero(), d});
    }
  }
  const auto a = forwards.points(), b = backwards.points();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].number, b[i].number);
  EXPECT_GE(a.size(), 200U);
  EXPECT_EQ(forwards.least()->number, backwards.least()->number);
  // What another choice of all points keeps is what there is, and no more.
  std::size_t kept = 0;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    kept += forwards.keeps({i, Eigen::Vector3d::Zero(), std::sin(static_cast<double>(i))}) ? 1 : 0;
  }
  EXPECT_EQ(kept, a.size());
  EXPECT_TRUE(PointSample(50).keeps({0, Eigen::Vector3d::Zero(), 0})) << "an empty choice";
}

}  // namespace
}  // namespace abbe
