#include "abbe/verify/evaluations/diagonals.h"

#include <gtest/gtest.h>

#include <cmath>

namespace abbe {
namespace {

/// Means 0 and `slope` up, lower by `reversal` down; two runs that differ by `spread`.
DiagonalReadings diagonal(const std::string& name, double slope, double reversal, double spread = 0) {
  DiagonalReadings result{name, {}};
  for (const double run : {-0.5, 0.5}) {
    for (const double target : {0.0, 500.0}) {
      const double mean = target > 0 ? slope : 0;
      result.readings.push_back({target, mean + run * spread, ApproachDirection::positive});
      result.readings.push_back({target, mean - reversal + run * spread, ApproachDirection::negative});
    }
  }
  return result;
}

TEST(Diagonals, TakeTheLargestOfEveryFigureAndSayWhoseItIs) {
  const DiagonalsEvaluation e = evaluate_diagonals(
      {diagonal("PPP", 8, 1), diagonal("NPP", -9, 0.5), diagonal("PNP", 2, 3), diagonal("PPN", 1, 0, 2)});
  EXPECT_EQ(e.systematic.figure.value, 9.5);
  EXPECT_EQ(e.diagonals[e.systematic.diagonal].name, "NPP");
  EXPECT_EQ(e.reversal.figure.value, 3);
  EXPECT_EQ(e.reversal.diagonal, 2U);
  // s of a pair 2 apart is sqrt 2, R = 4 s.
  EXPECT_DOUBLE_EQ(e.repeatability.figure.value, 4 * std::sqrt(2.0));
  EXPECT_EQ(e.repeatability.diagonal, 3U);
  EXPECT_EQ(e.accuracy.figure.value, 9.5);
}

TEST(Diagonals, SquarenessLengthensOneDiagonalOfAFaceAndShortensTheOther) {
  // A square of side a sheared by g: its diagonals change by +-g a / sqrt 2 (first order). Both show E = that.
  const double change = 20e-6 * 500 / std::sqrt(2.0);
  const DiagonalsEvaluation e = evaluate_diagonals({diagonal("+X+Y", change, 0), diagonal("-X+Y", -change, 0)});
  EXPECT_NEAR(e.systematic.figure.value, change, 1e-15);
  EXPECT_NEAR(e.diagonals[0].positioning.mean_bidirectional.high, change, 1e-15);
  EXPECT_NEAR(e.diagonals[1].positioning.mean_bidirectional.low, -change, 1e-15);
}

TEST(Diagonals, ADiagonalWithoutAFigureWithholdsTheLargest) {
  DiagonalReadings once = diagonal("NPP", 100, 0);
  once.readings.resize(4);
  const DiagonalsEvaluation e = evaluate_diagonals({diagonal("PPP", 8, 1), once});
  EXPECT_EQ(e.repeatability.figure.status, FigureStatus::needs_two_runs);
  EXPECT_EQ(e.repeatability.diagonal, 1U);
  EXPECT_TRUE(e.systematic.figure.is_evaluated());
  EXPECT_EQ(evaluate_diagonals({}).systematic.figure.status, FigureStatus::no_readings);
}

}  // namespace
}  // namespace abbe
