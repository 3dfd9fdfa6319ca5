// Second optima of minimum zone, inscribed and robust fits are found and said.
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <numbers>
#include <string>

#include "abbe/geometry/fits/extreme_fit.h"
#include "abbe/geometry/fits/numbers_for_test.h"
#include "abbe/geometry/fits/robust_fit.h"
#include "abbe/geometry/fits/shape_points_for_test.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::Numbers;
using test::PatchOptions;

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
  EXPECT_NEAR(fit.rivals[0].form, 10, 1e-9);
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
    const Index k = i - count * count, row = i / count;
    const Vector3d share = k < 0 ? Vector3d(static_cast<double>(i % count) / (count - 1) - 0.5,
                                            static_cast<double>(row) / (count - 1) - 0.5, 0)
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
  EXPECT_NEAR(fit.rivals[0].form, 10, 1e-9);
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
  EXPECT_GT(fit.rivals[0].form, 10);
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
  EXPECT_NEAR(fit.rivals[0].shape.radius, 4.5005, 1e-3);
  EXPECT_NEAR((fit.rivals[0].shape.point - fit.shape.point).norm(), 8.9, 0.02);
}

/// Twice the largest distance from a shape; circumscribed or inscribed: the radius about its centre or axis.
double value_of(Shape shape, ExtremeKind extreme, const Matrix3Xd& points) {
  if (extreme != ExtremeKind::minimum_zone) shape.radius = 0;
  double largest = 0, smallest = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < points.cols(); ++i) {
    const double d = std::abs(distance(shape, points.col(i)));
    largest = std::max(largest, d);
    smallest = std::min(smallest, d);
  }
  return extreme == ExtremeKind::minimum_zone ? 2 * largest : extreme == ExtremeKind::inscribed ? smallest : largest;
}

/// The shape moved a little in every way that is free to it.
Shape beside(Shape shape, const FitConstraints& held, double reach, Numbers& numbers) {
  const bool in_plane = shape.kind == ShapeKind::line2 || shape.kind == ShapeKind::circle2;
  const auto any = [&] { return Vector3d(numbers.normal(), numbers.normal(), in_plane ? 0 : numbers.normal()); };
  shape.point += reach * any();
  if (shape.kind != ShapeKind::sphere && shape.kind != ShapeKind::circle2) {
    shape.direction = (shape.direction + 0.05 * reach * any()).normalized();
  }
  if (!held.radius && shape.kind >= ShapeKind::circle2) shape.radius += reach * numbers.normal();
  if (shape.kind == ShapeKind::cone) shape.half_angle += 0.05 * reach * numbers.normal();
  return shape;
}

/// @return how many rivals were named
std::size_t check_rivals(ShapeKind kind, ExtremeKind extreme, const Matrix3Xd& points, const FitConstraints& held,
                         Numbers& numbers) {
  FitOptions options;
  options.constraints = held;
  const ShapeFit fit = extreme_fit(kind, extreme, points, options);
  if (fit.status != FitStatus::ok && fit.status != FitStatus::ambiguous) return 0;
  const double sense = extreme == ExtremeKind::inscribed ? -1 : 1;
  double before = extreme == ExtremeKind::minimum_zone ? fit.form : fit.shape.radius;
  for (const ShapeRival& rival : fit.rivals) {
    const double value = extreme == ExtremeKind::minimum_zone ? rival.form : rival.shape.radius;
    EXPECT_GE(sense * (value - before), 0) << shape_name(kind) << ": best first";
    before = value;
    EXPECT_NEAR(value, value_of(rival.shape, extreme, points), 1e-9) << shape_name(kind);
    const test::ShapeDifference off = test::difference(rival.shape, fit.shape);
    EXPECT_GT(off.length + off.angle, 1e-4) << shape_name(kind);
    for (int trial = 0; trial < 60; ++trial) {
      const Shape other = beside(rival.shape, held, std::pow(10, numbers.uniform(-7, -4)), numbers);
      EXPECT_GE(sense * (value_of(other, extreme, points) - value), -1e-9) << shape_name(kind);
    }
  }
  return fit.rivals.size();
}

TEST(FitRivals, EveryRivalIsBetterThanAllShapesBesideIt) {
  Numbers numbers(45);
  struct Case {
    ShapeKind kind;
    ExtremeKind extreme;
    int parts;
    bool hold_radius;
    const char* group;
  };
  const ExtremeKind zone = ExtremeKind::minimum_zone, within = ExtremeKind::inscribed;
  std::map<std::string, std::size_t> rivals;
  for (const Case& one :
       {Case{ShapeKind::line2, zone, 20, false, "strips"}, Case{ShapeKind::line3, zone, 4, false, "tubes"},
        Case{ShapeKind::circle3, zone, 1, false, "tubes"}, Case{ShapeKind::plane, zone, 20, false, "slabs"},
        Case{ShapeKind::circle2, zone, 50, false, "rings"}, Case{ShapeKind::circle2, zone, 50, true, "held"},
        Case{ShapeKind::sphere, zone, 15, false, "shells"}, Case{ShapeKind::sphere, zone, 15, true, "held"},
        Case{ShapeKind::cylinder, zone, 6, false, "cylinders"}, Case{ShapeKind::cone, zone, 6, false, "cones"},
        Case{ShapeKind::circle2, within, 40, false, "inscribed"},
        Case{ShapeKind::sphere, within, 10, false, "inscribed"},
        Case{ShapeKind::cylinder, within, 6, false, "cylinders within"},
        Case{ShapeKind::cylinder, ExtremeKind::circumscribed, 6, false, "cylinders around"}}) {
    PatchOptions patch;
    patch.points = one.kind == ShapeKind::circle2 ? 8 : 14;
    patch.radius = 10;
    patch.length = 15;
    for (int part = 0; part < one.parts; ++part) {
      const test::Patch known = test::patch(one.kind, patch, numbers);
      const double roughness = known.shape.radius > 0 ? 4 : 8;
      Matrix3Xd points = known.feet;
      for (Index i = 0; i < points.cols(); ++i) {
        points.col(i) += roughness * numbers.uniform(-1, 1) * known.normals.col(i);
        points.col(i) += roughness * numbers.uniform(-1, 1) * known.second.col(i);
      }
      FitConstraints held;
      if (one.hold_radius) held.radius = patch.radius;
      rivals[one.group] += check_rivals(one.kind, one.extreme, points, held, numbers);
    }
  }
  for (const auto& [group, count] : rivals) EXPECT_GT(count, 0u) << group;
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
  EXPECT_NEAR(uneven.rivals[0].share, 0.34, 0.01);
  EXPECT_NEAR(uneven.rivals[0].shape.point.z(), 1.5, 0.01);
  const ShapeFit clear = robust_fit(ShapeKind::plane, step(0.9, 600, numbers));
  ASSERT_EQ(clear.status, FitStatus::ok) << clear.reason;
  EXPECT_TRUE(clear.rivals.empty());
}

/// Points of two lines that cross in the middle.
Matrix3Xd crossing(double share, Numbers& numbers) {
  Matrix3Xd points(3, 400);
  for (Index i = 0; i < points.cols(); ++i) {
    const double along = numbers.uniform(-20, 20), across = 0.01 * numbers.normal();
    if (static_cast<double>(i) < share * 400) {
      points.col(i) << along, across, 0;
    } else {
      points.col(i) << across, along, 0;
    }
  }
  return points;
}

TEST(FitRivals, ARobustLineNamesTheOneThatCrossesItsMiddle) {
  Numbers numbers(46);
  const ShapeFit even = robust_fit(ShapeKind::line2, crossing(0.52, numbers));
  EXPECT_EQ(even.status, FitStatus::ambiguous) << even.reason;
  for (const ShapeKind kind : {ShapeKind::line2, ShapeKind::line3}) {
    const ShapeFit uneven = robust_fit(kind, crossing(0.65, numbers));
    ASSERT_EQ(uneven.status, FitStatus::ok) << uneven.reason;
    EXPECT_NEAR(uneven.shape.direction.x(), 1, 1e-4);
    ASSERT_EQ(uneven.rivals.size(), 1u) << shape_name(kind);
    EXPECT_NEAR(uneven.rivals[0].share, 0.35, 0.01);
    EXPECT_NEAR(uneven.rivals[0].shape.direction.y(), 1, 1e-4);
    EXPECT_NEAR(uneven.rivals[0].shape.point.x(), 0, 0.004);
  }
  // A quarter of the points is no rival.
  const ShapeFit clear = robust_fit(ShapeKind::line2, crossing(0.78, numbers));
  ASSERT_EQ(clear.status, FitStatus::ok) << clear.reason;
  EXPECT_TRUE(clear.rivals.empty());
}

TEST(FitRivals, ARobustCircleNamesAConcentricOne) {
  Numbers numbers(47);
  Matrix3Xd points(3, 500);
  for (Index i = 0; i < points.cols(); ++i) {
    const double turn = numbers.uniform(0, 6.28), radius = (i % 5 < 3 ? 10 : 14) + 0.005 * numbers.normal();
    points.col(i) << 3 + radius * std::cos(turn), radius * std::sin(turn), 0;
  }
  const ShapeFit fit = robust_fit(ShapeKind::circle2, points);
  ASSERT_EQ(fit.status, FitStatus::ok) << fit.reason;
  EXPECT_NEAR(fit.shape.radius, 10, 0.002);
  ASSERT_EQ(fit.rivals.size(), 1u);
  EXPECT_NEAR(fit.rivals[0].shape.radius, 14, 0.002);
  EXPECT_NEAR((fit.rivals[0].shape.point - fit.shape.point).norm(), 0, 0.003);
  EXPECT_NEAR(fit.rivals[0].share, 0.4, 0.01);
}

}  // namespace
}  // namespace abbe
