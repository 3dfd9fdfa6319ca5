#include "abbe/geometry/fits/robust_fit.h"

#include <gtest/gtest.h>

#include "abbe/geometry/fits/numbers_for_test.h"
#include "abbe/geometry/fits/shape_points_for_test.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::Numbers;
using test::PatchOptions;

/// Points of a patch with noise; the last share of them anywhere around.
Matrix3Xd with_outliers(const test::Patch& patch, double noise, double share, Numbers& numbers) {
  Matrix3Xd points = patch.feet;
  const Index good = static_cast<Index>((1 - share) * static_cast<double>(points.cols()));
  const Vector3d middle = points.rowwise().mean();
  const bool in_plane = patch.shape.kind == ShapeKind::line2 || patch.shape.kind == ShapeKind::circle2;
  for (Index i = 0; i < points.cols(); ++i) {
    points.col(i) += noise * (numbers.normal() * patch.normals.col(i) + numbers.normal() * patch.second.col(i));
    if (i < good) continue;
    points.col(i) = middle + numbers.uniform(2, 40) * numbers.direction();
    if (in_plane) points(2, i) = 0;
  }
  return points;
}

TEST(RobustFit, ThirtyPercentOutliersDoNotMoveTheShape) {
  Numbers numbers(11);
  for (const ShapeKind kind : test::all_kinds()) {
    for (const double far : {0.0, 1e6}) {
      const RobustKind robust = far > 0 ? RobustKind::welsch : RobustKind::tukey;
      PatchOptions options;
      options.points = 300;
      options.far = far;
      const test::Patch patch = test::patch(kind, options, numbers);
      const Matrix3Xd points = with_outliers(patch, 0.005, 0.3, numbers);
      RobustOptions robust_options;
      robust_options.kind = robust;
      const ShapeFit fit = robust_fit(kind, points, robust_options);
      ASSERT_EQ(fit.status, FitStatus::ok) << shape_name(kind) << ": " << fit.reason;
      // Within five standard uncertainties of what was made.
      const test::ShapeDifference off = test::difference(fit.shape, patch.shape);
      EXPECT_LT(off.length, 0.01) << shape_name(kind);
      EXPECT_LT(off.angle, 0.001) << shape_name(kind);
      EXPECT_NEAR(fit.sigma, 0.005, 0.002) << shape_name(kind);
      EXPECT_GT(fit.rejected, 60U) << shape_name(kind);
    }
  }
}

TEST(RobustFit, WithoutOutliersItIsNearTheLeastSquaresShape) {
  Numbers numbers(12);
  for (const ShapeKind kind : test::all_kinds()) {
    const test::Patch patch = test::patch(kind, {}, numbers);
    const Matrix3Xd points = with_outliers(patch, 0.01, 0, numbers);
    for (const RobustKind robust : {RobustKind::huber, RobustKind::tukey, RobustKind::welsch}) {
      RobustOptions robust_options;
      robust_options.kind = robust;
      const ShapeFit fit = robust_fit(kind, points, robust_options), least = least_squares_fit(kind, points);
      ASSERT_EQ(fit.status, FitStatus::ok) << shape_name(kind) << ": " << fit.reason;
      const test::ShapeDifference off = test::difference(fit.shape, least.shape);
      EXPECT_LT(off.length, 0.002) << shape_name(kind);
      EXPECT_LT(off.angle, 1e-4) << shape_name(kind);
      EXPECT_NEAR(fit.sigma, least.sigma, 0.15 * least.sigma) << shape_name(kind);
    }
  }
}

TEST(RobustFit, ExactPointsAmongOutliersGiveTheExactShape) {
  Numbers numbers(15);
  for (const ShapeKind kind : {ShapeKind::plane, ShapeKind::circle3, ShapeKind::sphere, ShapeKind::cylinder}) {
    const test::Patch patch = test::patch(kind, {}, numbers);
    const ShapeFit fit = robust_fit(kind, with_outliers(patch, 0, 0.3, numbers));
    ASSERT_EQ(fit.status, FitStatus::ok) << shape_name(kind) << ": " << fit.reason;
    const test::ShapeDifference off = test::difference(fit.shape, patch.shape);
    EXPECT_LT(off.length, 1e-9) << shape_name(kind);
    EXPECT_LT(off.angle, 1e-10) << shape_name(kind);
    EXPECT_GE(fit.rejected, 80U) << shape_name(kind);
  }
}

TEST(RobustFit, LongThinCylinderAndShortArcWithOutliers) {
  Numbers numbers(16);
  PatchOptions options;
  options.points = 300;
  options.length = 400;
  options.radius = 8;
  const test::Patch thin = test::patch(ShapeKind::cylinder, options, numbers);
  const ShapeFit fit = robust_fit(ShapeKind::cylinder, with_outliers(thin, 0.005, 0.3, numbers));
  ASSERT_EQ(fit.status, FitStatus::ok) << fit.reason;
  EXPECT_LT(test::difference(fit.shape, thin.shape).length, 0.01);
  options.arc = 1;
  options.radius = 20;
  options.length = 40;
  const test::Patch arc = test::patch(ShapeKind::cylinder, options, numbers);
  const ShapeFit part = robust_fit(ShapeKind::cylinder, with_outliers(arc, 0.002, 0.3, numbers));
  ASSERT_EQ(part.status, FitStatus::ok) << part.reason;
  EXPECT_LT(test::difference(part.shape, arc.shape).length, 0.05);
}

TEST(RobustFit, RandomPointsAreNoShape) {
  Numbers numbers(13);
  Matrix3Xd points(3, 300);
  for (Index i = 0; i < points.cols(); ++i) {
    points.col(i) << numbers.uniform(-5, 5), numbers.uniform(-5, 5), numbers.uniform(-5, 5);
  }
  for (const ShapeKind kind : {ShapeKind::line3, ShapeKind::plane, ShapeKind::circle3}) {
    EXPECT_NE(robust_fit(kind, points).status, FitStatus::ok) << shape_name(kind);
  }
}

TEST(RobustFit, SameSeedSameBits) {
  Numbers numbers(14);
  const test::Patch patch = test::patch(ShapeKind::sphere, {}, numbers);
  const Matrix3Xd points = with_outliers(patch, 0.01, 0.2, numbers);
  const ShapeFit a = robust_fit(ShapeKind::sphere, points), b = robust_fit(ShapeKind::sphere, points);
  EXPECT_EQ(a.shape.point, b.shape.point);
  EXPECT_EQ(a.shape.radius, b.shape.radius);
}

}  // namespace
}  // namespace abbe
