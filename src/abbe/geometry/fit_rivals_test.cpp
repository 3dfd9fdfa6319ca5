// Second optima of minimum zone, inscribed and robust fits are found and said.
#include <gtest/gtest.h>

#include <limits>

#include "abbe/geometry/extreme_fit.h"
#include "abbe/geometry/robust_fit.h"
#include "abbe/geometry/shape_points_for_test.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::Numbers;

/// Points anywhere in a box, its corners among them, turned and moved.
Matrix3Xd box_of_points(const Vector3d& size, Index count, Numbers& numbers) {
  Matrix3Xd points(3, count);
  for (Index i = 0; i < count; ++i) {
    Vector3d share(numbers.uniform(0, 1), numbers.uniform(0, 1), numbers.uniform(0, 1));
    if (i < 8)
      share = Vector3d(static_cast<double>(i & 1), static_cast<double>(i >> 1 & 1), static_cast<double>(i >> 2));
    points.col(i) = (share.array() - 0.5).matrix().cwiseProduct(size);
  }
  const bool flat = size.z() == 0;
  const Eigen::Matrix3d turn = rotation_about(flat ? Vector3d(0, 0, 1) : numbers.direction(), 0.4);
  return (turn * points).colwise() + Vector3d(300, -200, flat ? 0 : 50);
}

TEST(FitRivals, TheStripAcrossABoxIsNamedBesideTheNarrowerOne) {
  Numbers numbers(41);
  const Matrix3Xd points = box_of_points({10, 9.5, 0}, 3000, numbers);
  const ShapeFit fit = extreme_fit(ShapeKind::line2, ExtremeKind::minimum_zone, points);
  ASSERT_EQ(fit.status, FitStatus::ok) << fit.reason;
  EXPECT_NEAR(fit.form, 9.5, 1e-9);
  ASSERT_FALSE(fit.rivals.empty());
  EXPECT_NEAR(fit.rivals[0].value, 10, 1e-9);
  EXPECT_NEAR(fit.rivals[0].shape.direction.dot(fit.shape.direction), 0, 1e-9);
  // Corners of a square around the same points, whose least-squares line is well determined.
  Matrix3Xd in_a_square = points;
  in_a_square.leftCols(8) = box_of_points({10, 10 - 1e-6, 0}, 8, numbers);
  const ShapeFit square = extreme_fit(ShapeKind::line2, ExtremeKind::minimum_zone, in_a_square);
  EXPECT_EQ(square.status, FitStatus::ambiguous) << square.reason;
}

/// All places of a grid of so many points, and `more` pairs at the ends of its middle line along y.
Matrix3Xd grid_with_ends(const Vector3d& size, int count, int more) {
  Matrix3Xd points(3, count * count + 2 * more);
  for (Index i = 0; i < points.cols(); ++i) {
    const Index k = i - count * count;
    const Vector3d share = k < 0 ? Vector3d(static_cast<double>(i % count) / (count - 1) - 0.5,
                                            static_cast<double>(i / count) / (count - 1) - 0.5, 0)
                                 : Vector3d(0, k % 2 == 0 ? 0.5 : -0.5, 0);
    points.col(i) = share.cwiseProduct(size);
  }
  return points;
}

TEST(FitRivals, StripsOfASymmetricGridAllGoThroughItsMiddleAndAreToldApart) {
  const ShapeFit fit = extreme_fit(ShapeKind::line2, ExtremeKind::minimum_zone, grid_with_ends({10, 9.5, 0}, 9, 0));
  ASSERT_EQ(fit.status, FitStatus::ok) << fit.reason;
  EXPECT_NEAR(fit.form, 9.5, 1e-9);
  ASSERT_FALSE(fit.rivals.empty());
  EXPECT_NEAR(fit.rivals[0].value, 10, 1e-9);
  EXPECT_NEAR(fit.rivals[0].shape.direction.x(), 0, 1e-9);
  // Points at the ends of the shorter side make that the direction of least squares; the narrowest strip stays.
  const Matrix3Xd points = grid_with_ends({10, 9.5, 0}, 9, 20);
  ASSERT_NEAR(least_squares_fit(ShapeKind::line2, points).shape.direction.y(), 1, 1e-9);
  const ShapeFit across = extreme_fit(ShapeKind::line2, ExtremeKind::minimum_zone, points);
  ASSERT_EQ(across.status, FitStatus::ok) << across.reason;
  EXPECT_NEAR(across.form, 9.5, 1e-9);
  EXPECT_NEAR(across.shape.direction.x(), 1, 1e-9);
  const ShapeFit square = extreme_fit(ShapeKind::line2, ExtremeKind::minimum_zone, grid_with_ends({10, 10, 0}, 9, 20));
  EXPECT_EQ(square.status, FitStatus::ambiguous) << square.reason;
}

TEST(FitRivals, TheNarrowestSlabIsFoundWhereLeastSquaresBeginsInAnotherValley) {
  Numbers numbers(42);
  // Almost all points in a block that is thinnest along z; a few corners make it thinnest along y.
  Matrix3Xd points = box_of_points({12, 10, 9}, 4000, numbers);
  const ShapeFit alone = extreme_fit(ShapeKind::plane, ExtremeKind::minimum_zone, points);
  ASSERT_EQ(alone.status, FitStatus::ok) << alone.reason;
  EXPECT_NEAR(alone.form, 9, 1e-9);
  const Vector3d thin = alone.shape.direction, middle(300, -200, 50);
  points.col(100) = middle + 5.5 * thin;
  points.col(101) = middle - 5.5 * thin;
  const ShapeFit fit = extreme_fit(ShapeKind::plane, ExtremeKind::minimum_zone, points);
  ASSERT_EQ(fit.status, FitStatus::ok) << fit.reason;
  EXPECT_NEAR(fit.form, 10, 1e-9);
  EXPECT_NEAR(fit.shape.direction.dot(thin), 0, 1e-9);
  ASSERT_FALSE(fit.rivals.empty());
  EXPECT_GT(fit.rivals[0].value, 10);
}

TEST(FitRivals, TheLargerOfTwoRoomsIsInscribedAndTheOtherNamed) {
  Numbers numbers(44);
  Matrix3Xd points = Matrix3Xd::Zero(3, 800);
  // Two round rooms with rough walls and a door between them.
  for (Index i = 0; i < 800; ++i) {
    const bool large = i % 2 == 0;
    const Index place = i / 2;
    const double t = 0.4 + (2 * std::numbers::pi - 0.8) * static_cast<double>(place) / 399;
    const double radius = (large ? 5 : 4.5) + numbers.uniform(0, 0.01);
    points.col(i) << (large ? 4.6 - radius * std::cos(t) : -4.3 + radius * std::cos(t)), radius * std::sin(t), 0;
  }
  const ShapeFit fit = extreme_fit(ShapeKind::circle2, ExtremeKind::inscribed, points);
  ASSERT_EQ(fit.status, FitStatus::ok) << fit.reason;
  EXPECT_NEAR(fit.shape.radius, 5.0005, 1e-3);
  ASSERT_FALSE(fit.rivals.empty());
  EXPECT_NEAR(fit.rivals[0].value, 4.5005, 1e-3);
  EXPECT_NEAR((fit.rivals[0].shape.point - fit.shape.point).norm(), 8.9, 0.02);
}

/// Points of two parallel planes.
Matrix3Xd step(double share, Index count, Numbers& numbers) {
  Matrix3Xd points(3, count);
  for (Index i = 0; i < count; ++i) {
    const double height = static_cast<double>(i) < share * static_cast<double>(count) ? 0 : 1.5;
    points.col(i) << numbers.uniform(-20, 20), numbers.uniform(-20, 20), height + 0.01 * numbers.normal();
  }
  return points;
}

TEST(FitRivals, ARobustPlaneNamesTheOtherLevelOfAStep) {
  Numbers numbers(43);
  const ShapeFit even = robust_fit(ShapeKind::plane, step(0.52, 600, numbers));
  EXPECT_EQ(even.status, FitStatus::ambiguous);
  EXPECT_NE(even.reason.find("another shape"), std::string::npos);
  const ShapeFit uneven = robust_fit(ShapeKind::plane, step(0.66, 600, numbers));
  ASSERT_EQ(uneven.status, FitStatus::ok) << uneven.reason;
  EXPECT_NEAR(uneven.shape.point.z(), 0, 0.003);
  ASSERT_EQ(uneven.rivals.size(), 1u);
  EXPECT_NEAR(uneven.rivals[0].value, 0.34, 0.01);
  EXPECT_NEAR(uneven.rivals[0].shape.point.z(), 1.5, 0.01);
  const ShapeFit clear = robust_fit(ShapeKind::plane, step(0.9, 600, numbers));
  ASSERT_EQ(clear.status, FitStatus::ok) << clear.reason;
  EXPECT_TRUE(clear.rivals.empty());
}

}  // namespace
}  // namespace abbe
