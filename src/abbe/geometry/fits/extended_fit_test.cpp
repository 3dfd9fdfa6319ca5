// The fits against a second solver in extended precision.
#include <gtest/gtest.h>

#include "abbe/geometry/fits/extended_fit_for_test.h"
#include "abbe/geometry/fits/extreme_fit.h"
#include "abbe/geometry/fits/numbers_for_test.h"
#include "abbe/geometry/fits/shape_points_for_test.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using test::kFitAngle;
using test::kFitLength;
using test::Numbers;
using test::PatchOptions;

struct FaintShape {
  ShapeKind kind;
  double arc_deg, far;
};

std::vector<FaintShape> cases() {
  std::vector<FaintShape> all;
  for (const ShapeKind kind : {ShapeKind::line3, ShapeKind::circle3, ShapeKind::cylinder, ShapeKind::cone}) {
    for (const double arc : {360., 90., 40., 20.}) {
      if (kind == ShapeKind::line3 && arc < 360) continue;
      for (const double far : {0., 1e6}) all.push_back({kind, arc, far});
    }
  }
  return all;
}

/// Points with independent errors of half a hundredth, or of a hundredth of the sagitta of a short arc.
Matrix3Xd rough(const test::Patch& patch, double arc, double radius, Numbers& numbers) {
  const double size = std::min(0.005, 0.01 * radius * (1 - std::cos(std::min(arc, 3.0) / 2)));
  Matrix3Xd points = patch.feet;
  for (Index i = 0; i < points.cols(); ++i) {
    points.col(i) += size * (numbers.normal() * patch.normals.col(i) + numbers.normal() * patch.second.col(i));
  }
  return points;
}

PatchOptions options_of(const FaintShape& one) {
  PatchOptions options;
  options.points = 120;
  options.arc = one.arc_deg * std::numbers::pi / 180;
  options.far = one.far;
  return options;
}

/// Away from the true shape, so that the second solver has to find the way itself.
test::ExtendedShape disturbed(const test::ExtendedShape& shape, Numbers& numbers) {
  test::ExtendedShape result = shape;
  // What a kind does not have stays zero.
  for (Index k = 0; k < (shape[6] > 0 ? 7 : 6); ++k) result[k] += (k < 3 || k == 6 ? 0.01 : 0.001) * numbers.normal();
  return result;
}

TEST(ExtendedFit, LeastSquaresAgreesWithASecondSolverOnShortArcsFarFromTheOrigin) {
  Numbers numbers(31);
  for (const FaintShape& one : cases()) {
    const PatchOptions options = options_of(one);
    const test::Patch patch = test::patch(one.kind, options, numbers);
    const Matrix3Xd points = rough(patch, options.arc, options.radius, numbers);
    const ShapeFit fit = least_squares_fit(one.kind, points);
    ASSERT_EQ(fit.status, FitStatus::ok) << shape_name(one.kind) << " " << one.arc_deg << ": " << fit.reason;
    const test::ExtendedPoints data(points);
    const Shape other =
        data.to(one.kind, test::extended_least_squares(one.kind, data, disturbed(data.from(patch.shape), numbers)));
    const test::ShapeDifference off = test::difference(fit.shape, other);
    EXPECT_LT(off.length, kFitLength) << shape_name(one.kind) << " " << one.arc_deg << " " << one.far;
    EXPECT_LT(off.angle, kFitAngle) << shape_name(one.kind) << " " << one.arc_deg << " " << one.far;
  }
}

TEST(ExtendedFit, MinimumZoneIsTheShapeOfItsContactsInExtendedPrecision) {
  Numbers numbers(32);
  for (const ShapeKind kind : {ShapeKind::plane, ShapeKind::sphere, ShapeKind::cylinder, ShapeKind::cone}) {
    for (const double arc_deg : {180., 60.}) {
      for (const double far : {0., 1e6}) {
        const PatchOptions options = options_of({kind, arc_deg, far});
        const test::Patch patch = test::patch(kind, options, numbers);
        const Matrix3Xd points = rough(patch, options.arc, options.radius, numbers);
        const ShapeFit fit = extreme_fit(kind, ExtremeKind::minimum_zone, points);
        ASSERT_EQ(fit.status, FitStatus::ok) << shape_name(kind) << ": " << fit.reason;
        ASSERT_EQ(fit.contacts.size(), static_cast<std::size_t>(fit.parameters) + 1) << shape_name(kind);
        const test::ExtendedPoints data(points);
        const test::ExtendedShape start = data.from(fit.shape);
        std::vector<Index> contacts;
        std::vector<int> signs;
        for (const std::size_t k : fit.contacts) {
          contacts.push_back(static_cast<Index>(k));
          signs.push_back(test::extended_residuals(kind, start, data.points.col(contacts.back()))[0] > 0 ? 1 : -1);
        }
        const test::ExtendedShape found = test::extended_contact_shape(kind, data, contacts, signs, start);
        const test::ShapeDifference off = test::difference(fit.shape, data.to(kind, found));
        EXPECT_LT(off.length, kFitLength) << shape_name(kind) << " " << arc_deg << " " << far;
        EXPECT_LT(off.angle, kFitAngle) << shape_name(kind) << " " << arc_deg << " " << far;
        // That the multipliers are positive was the library's word: here they are those of the second solver.
        const auto distances = [&](const test::ExtendedShape& s) {
          test::ExtendedVector all(static_cast<Index>(contacts.size()));
          for (std::size_t k = 0; k < contacts.size(); ++k) {
            all[static_cast<Index>(k)] = static_cast<test::Extended>(signs[k]) *
                                         test::extended_residuals(kind, s, data.points.col(contacts[k]))[0];
          }
          return all;
        };
        const test::ExtendedMatrix slopes = test::extended_slopes(distances, found);
        test::ExtendedMatrix system(9, slopes.rows());
        system << slopes.transpose(), test::ExtendedVector::Ones(slopes.rows()).transpose();
        test::ExtendedVector right = test::ExtendedVector::Zero(9);
        right[8] = 1;
        const test::ExtendedVector multipliers =
            Eigen::CompleteOrthogonalDecomposition<test::ExtendedMatrix>(system).solve(right);
        EXPECT_LT(static_cast<double>((system * multipliers - right).norm()), 1e-9) << shape_name(kind);
        EXPECT_GT(static_cast<double>(multipliers.minCoeff()), 0) << shape_name(kind);
        // No point is outside of the zone.
        const test::Extended zone = distances(found)[0];
        for (Index i = 0; i < points.cols(); ++i) {
          const test::Extended d = test::extended_residuals(kind, found, data.points.col(i))[0];
          ASSERT_LE(static_cast<double>(std::abs(d) - zone), 1e-11) << shape_name(kind);
        }
      }
    }
  }
}

}  // namespace
}  // namespace abbe
