#include "abbe/verify/evaluations/straightness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace abbe {
namespace {

struct Readings {
  std::vector<double> x, y;
};

double width_at(const Readings& r, double slope) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t i = 0; i < r.x.size(); ++i) {
    low = std::min(low, r.y[i] - slope * r.x[i]);
    high = std::max(high, r.y[i] - slope * r.x[i]);
  }
  return high - low;
}

/// Independent route: the best slope is one between two of the points.
double narrowest_by_all_pairs(const Readings& r) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < r.x.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (r.x[i] != r.x[j]) best = std::min(best, width_at(r, (r.y[i] - r.y[j]) / (r.x[i] - r.x[j])));
    }
  }
  return best;
}

Readings random_readings(std::mt19937_64& random, std::size_t n, bool coarse) {
  std::uniform_int_distribution<int> grid(0, 6);
  std::normal_distribution<double> noise(0, 0.004);
  Readings r;
  for (std::size_t i = 0; i < n; ++i) {
    r.x.push_back(coarse ? 100.0 * grid(random) : 600.0 * noise(random));
    r.y.push_back(coarse ? 0.001 * grid(random) : noise(random));
  }
  r.x[0] = -50, r.x[1] = 650, r.x[2] = 250;
  return r;
}

TEST(Straightness, OfThreePointsAgreesWithTheHandCalculation) {
  // The middle point of (0, 0), (100, 3), (200, 0) um: LS line at 1 um, deviations -1, 2, -1.
  const std::vector<double> x{0, 100, 200}, y{0, 0.003, 0};
  const Straightness ls = straightness(x, y, ReferenceLine::least_squares, 0.0003);
  ASSERT_EQ(ls.status, StraightnessStatus::done);
  EXPECT_NEAR(ls.line.at(100), 0.001, 1e-15);
  EXPECT_NEAR(ls.value, 0.003, 1e-15);
  EXPECT_EQ(ls.largest_at, 1U);
  EXPECT_NEAR(ls.scatter, std::sqrt(6.0) * 0.001, 1e-15);
  EXPECT_NEAR(ls.slope_uncertainty, std::sqrt(6.0) * 0.001 / std::sqrt(20000.0), 1e-15);
  // Largest less smallest = y2 - (y1 + y3)/2 had both ends the same weight; here it is point 2 less point 1.
  const double run = 100;
  EXPECT_NEAR(ls.value_uncertainty, 0.0003 * std::sqrt(2 - run * run / 20000), 1e-15);

  const Straightness zone = straightness(x, y, ReferenceLine::minimum_zone, 0.0003);
  EXPECT_NEAR(zone.value, 0.003, 1e-15);
  EXPECT_NEAR(zone.largest, 0.0015, 1e-15);
  EXPECT_NEAR(zone.smallest, -0.0015, 1e-15);
  EXPECT_NEAR(zone.value_uncertainty, 0.0003 * std::sqrt(1.5), 1e-15);
}

TEST(Straightness, MinimumZoneIsTheNarrowestOfAllPairsOfPoints) {
  std::mt19937_64 random(230'1);
  for (int repetition = 0; repetition < 400; ++repetition) {
    const Readings r = random_readings(random, 3 + static_cast<std::size_t>(repetition % 12), repetition % 2 == 0);
    const Straightness zone = straightness(r.x, r.y, ReferenceLine::minimum_zone);
    const Straightness ls = straightness(r.x, r.y, ReferenceLine::least_squares);
    EXPECT_NEAR(zone.value, narrowest_by_all_pairs(r), 1e-13) << repetition;
    EXPECT_NEAR(width_at(r, zone.line.slope), zone.value, 1e-13) << repetition;
    EXPECT_LE(zone.value, ls.value + 1e-15);
  }
}

TEST(Straightness, DoesNotDependOnShiftSlopeOrOrder) {
  std::mt19937_64 random(230'2);
  for (const ReferenceLine reference : {ReferenceLine::least_squares, ReferenceLine::minimum_zone}) {
    const Readings r = random_readings(random, 40, false);
    const Straightness plain = straightness(r.x, r.y, reference, 1e-4);
    Readings moved = r;
    for (std::size_t i = 0; i < r.x.size(); ++i) {
      moved.x[i] = 3000 + r.x[i];
      moved.y[i] = r.y[i] + 0.7 + 2e-4 * r.x[i];
    }
    std::reverse(moved.x.begin(), moved.x.end());
    std::reverse(moved.y.begin(), moved.y.end());
    const Straightness other = straightness(moved.x, moved.y, reference, 1e-4);
    EXPECT_NEAR(other.value, plain.value, 1e-12);
    EXPECT_NEAR(other.line.slope, plain.line.slope + 2e-4, 1e-14);
    EXPECT_NEAR(other.value_uncertainty, plain.value_uncertainty, 1e-12);
    EXPECT_EQ(other.largest_at, r.x.size() - 1 - plain.largest_at);
  }
}

TEST(Straightness, UncertaintiesAgreeWithRepeatedSimulation) {
  // A clear hill, so that the touching points do not change with the noise.
  std::mt19937_64 random(230'3);
  std::normal_distribution<double> noise(0, 1e-4);
  std::vector<double> x, hill;
  for (int i = 0; i <= 20; ++i) {
    x.push_back(50.0 * i);
    hill.push_back(i == 0 || i == 20 || i == 7 ? (i == 7 ? 0.01 : -0.004) : 0);
  }
  for (const ReferenceLine reference : {ReferenceLine::least_squares, ReferenceLine::minimum_zone}) {
    const Straightness exact = straightness(x, hill, reference, 1e-4);
    double mean = 0, squares = 0;
    const int repetitions = 4000;
    for (int k = 0; k < repetitions; ++k) {
      std::vector<double> y = hill;
      for (double& value : y) value += noise(random);
      const double value = straightness(x, y, reference).value - exact.value;
      mean += value / repetitions;
      squares += value * value / repetitions;
    }
    EXPECT_NEAR(std::sqrt(squares - mean * mean) / exact.value_uncertainty, 1, 0.06)
        << "reference " << static_cast<int>(reference);
  }
}

TEST(Straightness, PositionsThatAreNearlyTheSameAreOne) {
  const double tiny = 1e-317;
  const Straightness zone =
      straightness(std::vector<double>{0, tiny, 100, 100 + 1e-13, 200}, std::vector<double>{0, 0.001, 0.002, -1, 0},
                   ReferenceLine::minimum_zone, 1e-4);
  ASSERT_EQ(zone.status, StraightnessStatus::done);
  EXPECT_TRUE(std::isfinite(zone.value) && std::isfinite(zone.line.slope) && std::isfinite(zone.value_uncertainty));
  EXPECT_TRUE(std::isfinite(zone.slope_uncertainty));
  // Zone through -1 at 100 and the highest points elsewhere: 0.002 there is above the chord of 0.001 and 0.
  EXPECT_NEAR(zone.value, 1.002, 1e-12);
}

TEST(Straightness, WhereManySlopesAreAsGoodTheOneNearestToLeastSquaresIsTaken) {
  // A repeat at the middle decides the width alone; any slope that keeps the ends inside is as good.
  const std::vector<double> x{0, 100, 100, 200}, y{0, -0.01, 0.01, 0};
  const Straightness zone = straightness(x, y, ReferenceLine::minimum_zone, 1e-4);
  EXPECT_NEAR(zone.value, 0.02, 1e-15);
  EXPECT_NEAR(zone.line.slope, 0, 1e-15);
  EXPECT_NEAR(zone.value_uncertainty, std::sqrt(2.0) * 1e-4, 1e-15);
  EXPECT_GT(zone.slope_uncertainty, 2e-4 / std::sqrt(12.0) - 1e-15);
}

TEST(Straightness, FewerThanThreePositionsGiveNoValue) {
  const std::vector<double> none;
  EXPECT_EQ(straightness(none, none, ReferenceLine::minimum_zone).status, StraightnessStatus::too_few_positions);
  for (const ReferenceLine reference : {ReferenceLine::least_squares, ReferenceLine::minimum_zone}) {
    const Straightness two = straightness(std::vector<double>{0, 0, 5, 5}, std::vector<double>{1, 2, 3, 4}, reference);
    EXPECT_EQ(two.status, StraightnessStatus::too_few_positions);
    EXPECT_EQ(two.value, 0);
    EXPECT_TRUE(two.deviations.empty());
  }
  EXPECT_EQ(Straightness{}.status, StraightnessStatus::not_run);
}

}  // namespace
}  // namespace abbe
