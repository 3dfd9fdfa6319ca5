// A sample of tests/property/fit_simulation_test.cpp, and small, clean and extreme sets.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "abbe/geometry/fits/simulated_fits_for_test.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using test::Numbers;
using test::SimulatedSet;

TEST(FitSimulation, SmallSetsHaveTheirLeastSquaresShape) { test::simulate_least_squares(100, 51); }
TEST(FitSimulation, SmallSetsHaveTheirMinimumZone) { test::simulate_extreme(ExtremeKind::minimum_zone, 6, 52); }
TEST(FitSimulation, SmallSetsHaveTheirCircumscribedShape) {
  test::simulate_extreme(ExtremeKind::circumscribed, 40, 53);
}
TEST(FitSimulation, SmallSetsHaveTheirInscribedShape) { test::simulate_extreme(ExtremeKind::inscribed, 40, 54); }
TEST(FitSimulation, SmallSetsHaveTheirRobustShape) { test::simulate_robust(12, 55); }

/// One of the sets that simulate_robust() would make with that seed.
SimulatedSet set_of(ShapeKind kind, std::uint64_t seed, int index) {
  Numbers numbers(seed);
  for (int k = 0; k < index; ++k) test::simulated_set(kind, numbers);
  return test::simulated_set(kind, numbers);
}

TEST(FitSimulation, RobustShapesThatWereRefusedOrNotTheOptimumHaveAnAnswer) {
  struct Case {
    ShapeKind kind;
    std::uint64_t seed;
    int index;
  };
  // The smallest median of so few points belonged to another shape, which leaves a larger loss.
  for (const Case& one :
       {Case{ShapeKind::circle2, 2026, 824}, Case{ShapeKind::sphere, 1, 448}, Case{ShapeKind::circle3, 3, 495},
        // 200 steps ended between a saddle and the optimum, or 1000 beside a saddle that is all but flat.
        Case{ShapeKind::circle3, 2, 942}, Case{ShapeKind::line2, 3, 777}, Case{ShapeKind::cylinder, 5, 227},
        // The first step led higher, was not taken, and that was taken for rest.
        Case{ShapeKind::cone, 1, 1094}}) {
    const SimulatedSet set = set_of(one.kind, one.seed, one.index);
    const ShapeFit fit = robust_fit(one.kind, set.points);
    test::judge_robust(set, fit);
    EXPECT_LT(static_cast<double>(fit.rejected), 0.25 * static_cast<double>(set.count())) << test::words(set, fit);
  }
}

/// By chance nine of fourteen points are within 0.4 um of a plane, and all within the noise of another: each is the
/// better one at its own scale.
TEST(FitSimulation, ASetWithTwoRobustShapesIsAmbiguous) {
  const SimulatedSet set = set_of(ShapeKind::plane, 3, 20);
  const ShapeFit fit = robust_fit(ShapeKind::plane, set.points);
  EXPECT_EQ(fit.status, FitStatus::ambiguous) << test::words(set, fit);
  EXPECT_EQ(fit.rejected, 5u);
  EXPECT_EQ(fit.rivals.size(), 1u);
}

/// The flat rings and cones that were refused one time in two: 11 points, radius 32 mm, height 7 mm, noise 1 um.
TEST(FitSimulation, FlatRingsAndConesOfElevenPointsHaveAnAnswerInAnyOrderOfThePoints) {
  Numbers numbers(56);
  for (const ShapeKind kind : {ShapeKind::cylinder, ShapeKind::cone}) {
    for (int set = 0; set < 40; ++set) {
      Matrix3Xd points(3, 11);
      for (Index i = 0; i < points.cols(); ++i) {
        const double turn = 2 * std::numbers::pi * static_cast<double>(i) / 11, z = numbers.uniform(0, 7);
        const double r = 32 + (kind == ShapeKind::cone ? 0.3 * z : 0) + 1e-3 * numbers.normal();
        points.col(i) << r * std::cos(turn), r * std::sin(turn), z;
      }
      const ShapeFit fit = least_squares_fit(kind, points);
      const ShapeFit reversed = least_squares_fit(kind, points.rowwise().reverse());
      ASSERT_EQ(fit.status, FitStatus::ok) << shape_name(kind) << " " << set << ": " << fit.reason;
      ASSERT_EQ(reversed.status, FitStatus::ok) << shape_name(kind) << " " << set << ": " << reversed.reason;
      const test::ShapeDifference off = test::difference(reversed.shape, fit.shape);
      EXPECT_LT(off.length, 1e-9) << shape_name(kind);
      EXPECT_LT(off.angle, 1e-10) << shape_name(kind);
    }
  }
}

/// Other order, place, orientation and unit: the same distances of the points, to rounding of the moved points.
TEST(FitSimulation, TheAnswerMovesWithItsPoints) {
  Numbers numbers(57);
  for (const ShapeKind kind : test::all_kinds()) {
    const bool in_plane = kind == ShapeKind::line2 || kind == ShapeKind::circle2;
    for (int k = 0; k < 40; ++k) {
      const SimulatedSet set = test::simulated_set(kind, numbers);
      if (set.uncertainty > test::kDetermined) continue;
      const double scale = std::pow(10, numbers.uniform(-2, 2)), angle = numbers.uniform(-3, 3);
      const Eigen::Matrix3d turn = rotation_about(in_plane ? Eigen::Vector3d::UnitZ() : numbers.direction(), angle);
      Eigen::Vector3d shift = set.size * numbers.direction();
      if (in_plane) shift.z() = 0;
      const Matrix3Xd moved = (scale * (turn * set.points.rowwise().reverse())).colwise() + shift;
      const ShapeFit fit = least_squares_fit(kind, set.points), other = least_squares_fit(kind, moved);
      ASSERT_EQ(fit.status, FitStatus::ok) << test::words(set, fit);
      ASSERT_EQ(other.status, FitStatus::ok) << test::words(set, other);
      const Eigen::VectorXd a = test::distances_from(fit.shape, set.points).cwiseAbs();
      const Eigen::VectorXd b = test::distances_from(other.shape, moved).cwiseAbs().reverse() / scale;
      EXPECT_LE((a - b).norm(), 1e-5 * a.norm() + 10 * test::rounding_of(set)) << test::words(set, fit);
    }
  }
}

TEST(FitSimulation, AsManyPointsAsParametersAreMetExactlyAndHaveNoUncertainty) {
  Numbers numbers(58);
  for (const ShapeKind kind : {ShapeKind::plane, ShapeKind::circle2, ShapeKind::circle3, ShapeKind::sphere}) {
    SimulatedSet set = test::simulated_set(kind, numbers, true);
    const Index fewest = kind == ShapeKind::sphere ? 4 : 3;
    set.points = set.points.leftCols(fewest).eval();
    const ShapeFit fit = least_squares_fit(kind, set.points);
    ASSERT_EQ(fit.status, FitStatus::ok) << test::words(set, fit);
    EXPECT_LE(test::distances_from(fit.shape, set.points).norm(), 10 * test::rounding_of(set));
    EXPECT_FALSE(fit.has_covariance);
  }
}

TEST(FitSimulation, CoincidentAndCollinearPointsAreDegenerateByEveryCriterionFarFromTheOriginToo) {
  for (const double far : {0., 1e6}) {
    Matrix3Xd same = Matrix3Xd::Constant(3, 12, far + 0.1), line(3, 12);
    for (Index i = 0; i < 12; ++i)
      line.col(i) = Eigen::Vector3d(far, -far, 1) + 2.5 * static_cast<double>(i) * Eigen::Vector3d(1, 2, 2);
    for (const ShapeKind kind :
         {ShapeKind::plane, ShapeKind::circle3, ShapeKind::sphere, ShapeKind::cylinder, ShapeKind::cone}) {
      for (const Matrix3Xd& points : {same, line}) {
        EXPECT_EQ(least_squares_fit(kind, points).status, FitStatus::degenerate) << shape_name(kind);
        EXPECT_EQ(extreme_fit(kind, ExtremeKind::minimum_zone, points).status, FitStatus::degenerate)
            << shape_name(kind);
        EXPECT_EQ(robust_fit(kind, points).status, FitStatus::degenerate) << shape_name(kind);
      }
    }
  }
}

}  // namespace
}  // namespace abbe
