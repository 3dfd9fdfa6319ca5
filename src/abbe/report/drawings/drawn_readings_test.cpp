#include "abbe/report/drawings/drawn_readings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

namespace abbe {
namespace {

const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

std::vector<double> deviations(std::size_t n) {
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal;
  std::vector<double> values(n);
  for (double& value : values) value = normal(engine);
  return values;
}

/// Of pieces of `size` readings each, as processes find them.
DrawnReadings drawn_in_pieces(const std::vector<double>& values, std::size_t size) {
  DrawnReadings all(values.size());
  for (std::size_t begin = 0; begin < values.size(); begin += size) {
    DrawnReadings piece(values.size());
    for (std::size_t i = begin; i < std::min(values.size(), begin + size); ++i) {
      piece.add({static_cast<double>(i), 0, 0}, kUp, values[i]);
    }
    all.append(piece.chosen(), begin);
  }
  return all;
}

TEST(DrawnReadings, AllOfAFewAreDrawn) {
  const std::vector<double> values = deviations(30000);
  const SurfaceReadings found = drawn_in_pieces(values, 8192).readings();
  EXPECT_EQ(found.deviation_mm, values);
  EXPECT_EQ(found.foot(0, 29999), 29999);
  EXPECT_EQ(found.normal.col(5), kUp);
}

TEST(DrawnReadings, OfManyTheLargestAreDrawnAndOneOfEachFew) {
  const std::vector<double> values = deviations(1000000);
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return std::abs(values[a]) > std::abs(values[b]); });
  for (const std::size_t size : {std::size_t{4000}, std::size_t{60000}, values.size()}) {
    const std::vector<DrawnReading> found = drawn_in_pieces(values, size).chosen();
    EXPECT_LE(found.size(), kPointsDrawn);
    EXPECT_GT(found.size(), 9 * kPointsDrawn / 10);
    std::set<std::uint64_t> numbers;
    std::size_t even = 0;
    for (const DrawnReading& reading : found) {
      EXPECT_TRUE(numbers.empty() || *numbers.rbegin() < reading.number);
      numbers.insert(reading.number);
      ASSERT_EQ(reading.deviation_mm, values[reading.number]);
      ASSERT_EQ(reading.foot[0], static_cast<double>(reading.number));
      even += reading.is_of_group;
    }
    for (std::size_t k = 0; k < 200; ++k) EXPECT_TRUE(numbers.contains(order[k])) << size << ", " << k;
    EXPECT_GE(even + 200, found.size());
  }
}

TEST(DrawnReadings, OfEqualAmountsTheFirstOnesAreDrawn) {
  const std::vector<double> values(100000, 0.25);
  std::vector<std::uint64_t> by_amount;
  for (const DrawnReading& reading : drawn_in_pieces(values, 10000).chosen()) {
    if (reading.is_of_group == 0) by_amount.push_back(reading.number);
  }
  ASSERT_FALSE(by_amount.empty());
  EXPECT_LT(by_amount.back(), 200U);
}

}  // namespace
}  // namespace abbe
