#include "abbe/study/identification/turn_coverage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "abbe/errors/random_stream.h"

namespace abbe {
namespace {

Basis harmonics(int order) {
  Basis basis;
  basis.kind = BasisKind::fourier;
  basis.order = order;
  basis.period = 2 * std::numbers::pi;
  return basis;
}

/// The widest gap of sorted positions around the turn.
double widest_gap(std::vector<double> positions, double period) {
  for (double& position : positions) position -= period * std::floor(position / period);
  std::sort(positions.begin(), positions.end());
  double gap = positions.front() + period - positions.back();
  for (std::size_t i = 1; i < positions.size(); ++i) gap = std::max(gap, positions[i] - positions[i - 1]);
  return gap;
}

TEST(TurnCoverage, AsManyPositionsAsUnknownsCoverATurnEvenly) {
  for (const int order : {1, 2, 5, 40}) {
    const int count = 2 * order + 1;
    std::vector<double> positions;
    for (int k = 0; k < count; ++k) positions.push_back(-7 + 2 * std::numbers::pi * k / count);
    EXPECT_TRUE(covers_turn(positions, harmonics(order))) << order;
    positions.erase(positions.begin() + count / 2);
    EXPECT_FALSE(covers_turn(positions, harmonics(order))) << order;
  }
}

TEST(TurnCoverage, NoPositionsOrOnePlaceCoverNothing) {
  EXPECT_FALSE(covers_turn({}, harmonics(1)));
  EXPECT_FALSE(covers_turn(std::vector<double>(8, 0.3), harmonics(1)));
  EXPECT_FALSE(covers_turn(std::vector<double>{0, 2 * std::numbers::pi, -1e-17}, harmonics(1)));
}

TEST(TurnCoverage, IsThatOfTheWidestGap) {
  std::size_t covered = 0;
  for (std::size_t trial = 0; trial < 2000; ++trial) {
    RandomStream random(5, trial);
    const int order = 1 + static_cast<int>(trial % 4);
    std::vector<double> positions;
    const std::size_t count = 3 + trial % 40;
    for (std::size_t k = 0; k < count; ++k) positions.push_back(random.uniform(-20, 20));
    const Basis basis = harmonics(order);
    const bool expected = widest_gap(positions, basis.period) <= basis.period / (2 * order + 1);
    EXPECT_EQ(covers_turn(positions, basis), expected) << trial;
    covered += expected ? 1 : 0;
  }
  EXPECT_GT(covered, 400U);
  EXPECT_LT(covered, 1600U);
}

}  // namespace
}  // namespace abbe
