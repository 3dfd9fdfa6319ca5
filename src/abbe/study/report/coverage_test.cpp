#include "abbe/study/report/coverage.h"

#include <gtest/gtest.h>

namespace abbe {
namespace {

Basis over(BasisKind kind, int order, double from, double to) {
  Basis basis;
  basis.kind = kind;
  basis.order = order;
  basis.from = from;
  basis.to = to;
  return basis;
}

TEST(StatedRange, EndsAtTheTravelWithinTheMarginAndElseAtTheOutermostReading) {
  const Basis travel = over(BasisKind::legendre, 3, 0, 1400);
  EXPECT_EQ(stated_range(travel, {0.01, 1399.95}, 0.02), (PositionRange{0, 1400}));
  EXPECT_EQ(stated_range(travel, {0.01, 1399.95}, 0), (PositionRange{0.01, 1399.95}));
  EXPECT_EQ(stated_range(travel, {10, 1300}, 0.02), (PositionRange{0, 1300}));
  // The margin itself belongs to it: 2 % of 1372 mm.
  EXPECT_EQ(stated_range(travel, {0, 1372.549019607843}, 0.02), (PositionRange{0, 1400}));
  // Readings beyond what is asked for change nothing.
  EXPECT_EQ(stated_range(travel, {-50, 1450}, 0.02), (PositionRange{0, 1400}));
}

TEST(StatedRange, OfASplineNeedsReadingsInItsOuterIntervals) {
  // 70 intervals of 20 mm: half of one is 10 mm, less than 2 % of the range.
  for (const BasisKind kind : {BasisKind::bspline, BasisKind::table_linear}) {
    const Basis fine = over(kind, 70, 0, 1400);
    EXPECT_EQ(stated_range(fine, {9, 1392}, 0.02), (PositionRange{0, 1400}));
    EXPECT_EQ(stated_range(fine, {11, 1388}, 0.02), (PositionRange{11, 1388}));
  }
}

}  // namespace
}  // namespace abbe
