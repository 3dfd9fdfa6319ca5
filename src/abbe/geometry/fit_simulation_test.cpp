// Small sets of points of every shape, size, noise and place: each has an answer, and each answer is an optimum.
#include <gtest/gtest.h>

#include "abbe/geometry/simulated_fits_for_test.h"

namespace abbe {
namespace {

using test::Numbers;
using test::SimulatedSet;

constexpr int kSets = 60;  // of each shape

/// The sets of a shape that determine it.
template <class Judge>
void for_each_set(ShapeKind kind, int count, std::uint64_t seed, bool closed, const Judge& judge) {
  Numbers numbers(seed);
  int determined = 0;
  for (int k = 0; k < count; ++k) {
    const SimulatedSet set = test::simulated_set(kind, numbers, closed);
    if (set.uncertainty > test::kDetermined) continue;
    ++determined;
    judge(set);
    if (testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GT(determined, 3 * count / 4) << shape_name(kind);
}

TEST(FitSimulation, EverySmallSetHasItsLeastSquaresShape) {
  for (const ShapeKind kind : test::all_kinds()) {
    for_each_set(kind, 4 * kSets, 51, false, [&](const SimulatedSet& set) {
      test::judge_least_squares(set, least_squares_fit(kind, set.points));
    });
  }
}

}  // namespace
}  // namespace abbe
