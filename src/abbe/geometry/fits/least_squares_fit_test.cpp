#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <numeric>

#include "abbe/geometry/fits/numbers_for_test.h"
#include "abbe/geometry/fits/shape_fit.h"
#include "abbe/geometry/fits/shape_points_for_test.h"
#include "abbe/geometry/fits/shape_sums.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::kFitAngle;
using test::kFitLength;
using test::Numbers;
using test::PatchOptions;

void expect_same(const ShapeFit& fit, const Shape& truth, double length = kFitLength, double angle = kFitAngle) {
  ASSERT_EQ(fit.status, FitStatus::ok) << shape_name(truth.kind) << ": " << fit.reason;
  const test::ShapeDifference off = test::difference(fit.shape, truth);
  EXPECT_LT(off.length, length) << shape_name(truth.kind);
  EXPECT_LT(off.angle, angle) << shape_name(truth.kind);
}

TEST(LeastSquaresFit, FindsTheOptimumThatIsKnownByConstruction) {
  Numbers numbers(1);
  for (const ShapeKind kind : test::all_kinds()) {
    for (const double far : {0.0, 1e6}) {
      for (const double noise : {0.0, 0.01, 0.5}) {
        PatchOptions options;
        options.far = far;
        const test::Patch patch = test::patch(kind, options, numbers);
        const ShapeFit fit = least_squares_fit(kind, test::with_orthogonal_residuals(patch, noise, numbers));
        expect_same(fit, patch.shape);
        if (noise == 0) {
          EXPECT_LT(fit.form, 1e-9 + 4e-16 * far * 10);
        }
      }
    }
  }
}

TEST(LeastSquaresFit, FindsItOnShortArcsAndSmallPatchesFarFromTheOrigin) {
  Numbers numbers(2);
  for (const ShapeKind kind :
       {ShapeKind::circle2, ShapeKind::circle3, ShapeKind::sphere, ShapeKind::cylinder, ShapeKind::cone}) {
    for (const double arc_deg : {90., 40., 20.}) {
      for (int repetition = 0; repetition < 3; ++repetition) {
        PatchOptions options;
        options.arc = arc_deg * std::numbers::pi / 180;
        options.far = 1e6;
        options.points = 800;
        options.half_angle = numbers.uniform(0.1, 0.9);
        options.length = kind == ShapeKind::cone ? 30 : numbers.uniform(15, 60);
        const test::Patch patch = test::patch(kind, options, numbers);
        expect_same(least_squares_fit(kind, test::with_orthogonal_residuals(patch, 0.002, numbers)), patch.shape, 1e-7,
                    3e-9);
      }
    }
  }
}

TEST(LeastSquaresFit, HoldsWhatIsKnown) {
  Numbers numbers(3);
  for (const ShapeKind kind : {ShapeKind::circle2, ShapeKind::circle3, ShapeKind::sphere, ShapeKind::cylinder}) {
    for (const double arc : {6.28, 0.4}) {
      PatchOptions options;
      options.arc = arc;
      options.hold_radius = true;
      const test::Patch patch = test::patch(kind, options, numbers);
      FitOptions fit_options;
      fit_options.constraints.radius = options.radius;
      // Without orthogonality to the constant the free radius would be another one.
      const ShapeFit fit = least_squares_fit(kind, test::with_orthogonal_residuals(patch, 0.01, numbers), fit_options);
      expect_same(fit, patch.shape);
      EXPECT_EQ(fit.shape.radius, options.radius);
      EXPECT_EQ(fit.radius_uncertainty(), 0);
    }
  }
  for (const ShapeKind kind : {ShapeKind::plane, ShapeKind::cylinder}) {
    PatchOptions options;
    options.hold_direction = true;
    const test::Patch patch = test::patch(kind, options, numbers);
    FitOptions fit_options;
    fit_options.constraints.direction = -3 * patch.shape.direction;
    const ShapeFit fit = least_squares_fit(kind, test::with_orthogonal_residuals(patch, 0.01, numbers), fit_options);
    expect_same(fit, patch.shape, kFitLength, 1e-14);
    EXPECT_EQ(fit.direction_uncertainty(), 0);
  }
  PatchOptions options;
  options.hold_half_angle = true;
  const test::Patch patch = test::patch(ShapeKind::cone, options, numbers);
  FitOptions fit_options;
  fit_options.constraints.half_angle = options.half_angle;
  expect_same(least_squares_fit(ShapeKind::cone, test::with_orthogonal_residuals(patch, 0.01, numbers), fit_options),
              patch.shape);
}

TEST(LeastSquaresFit, RefusesConstraintsThatMeanNothing) {
  const Matrix3Xd points = Matrix3Xd::Random(3, 10);
  FitOptions options;
  options.constraints.radius = -1;
  EXPECT_THROW(least_squares_fit(ShapeKind::sphere, points, options), std::invalid_argument);
  options.constraints.radius = 1;
  EXPECT_THROW(least_squares_fit(ShapeKind::plane, points, options), std::invalid_argument);
  options.constraints = {};
  options.constraints.direction = Vector3d::Zero();
  EXPECT_THROW(least_squares_fit(ShapeKind::plane, points, options), std::invalid_argument);
  options.constraints.direction = Vector3d::UnitX();
  EXPECT_THROW(least_squares_fit(ShapeKind::sphere, points, options), std::invalid_argument);
}

TEST(LeastSquaresFit, MovesWithItsPointsScalesAndDoesNotCareForTheirOrder) {
  Numbers numbers(4);
  for (const ShapeKind kind : test::all_kinds()) {
    PatchOptions options;
    options.arc = 2;
    const test::Patch patch = test::patch(kind, options, numbers);
    Matrix3Xd points = patch.feet;
    const bool in_plane = kind == ShapeKind::line2 || kind == ShapeKind::circle2;
    for (Index i = 0; i < points.cols(); ++i) {
      points.col(i) += 0.02 * Vector3d(numbers.normal(), numbers.normal(), in_plane ? 0 : numbers.normal());
    }
    const ShapeFit fit = least_squares_fit(kind, points);
    const Eigen::Matrix3d turn = rotation_about(in_plane ? Vector3d(0, 0, 1) : numbers.direction(), 1.1);
    Vector3d shift = 500 * numbers.direction();
    if (in_plane) shift.z() = 0;
    const double scale = 3.7;
    Shape expected = fit.shape;
    expected.point = scale * (turn * fit.shape.point) + shift;
    expected.direction = kind == ShapeKind::circle2 ? fit.shape.direction : Vector3d(turn * fit.shape.direction);
    expected.radius *= scale;
    std::vector<Index> order(static_cast<std::size_t>(points.cols()));
    std::iota(order.begin(), order.end(), 0);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[numbers.bits() % i]);
    Matrix3Xd other(3, points.cols());
    for (Index i = 0; i < points.cols(); ++i) {
      other.col(i) = scale * (turn * points.col(order[static_cast<std::size_t>(i)])) + shift;
    }
    const ShapeFit again = least_squares_fit(kind, other);
    expect_same(again, expected, 1e-9, 1e-11);
    EXPECT_NEAR(again.rms, scale * fit.rms, 1e-10);
    EXPECT_NEAR(again.form, scale * fit.form, 1e-9);
    // The farthest points stay the same two; where no side is the outer one, they may change places.
    EXPECT_EQ(std::minmax({order[again.smallest_at], order[again.largest_at]}),
              std::minmax({static_cast<Index>(fit.smallest_at), static_cast<Index>(fit.largest_at)}));
  }
}

TEST(LeastSquaresFit, CovarianceIsTheScatterOfManyFits) {
  Numbers numbers(5);
  constexpr int kRuns = 300;
  constexpr double kSigma = 0.003;
  for (const ShapeKind kind : test::all_kinds()) {
    PatchOptions options;
    options.points = 60;
    options.arc = 2.5;
    const test::Patch patch = test::patch(kind, options, numbers);
    FitOptions stated;
    stated.sigma = kSigma;
    const ShapeFit reference = least_squares_fit(kind, patch.feet, stated);
    ASSERT_EQ(reference.status, FitStatus::ok) << reference.reason;
    Eigen::Matrix<double, 8, 8> scatter = Eigen::Matrix<double, 8, 8>::Zero();
    double sigma = 0;
    for (int run = 0; run < kRuns; ++run) {
      Matrix3Xd points = patch.feet;
      for (Index i = 0; i < points.cols(); ++i) {
        points.col(i) += kSigma * (numbers.normal() * patch.normals.col(i) + numbers.normal() * patch.second.col(i));
      }
      const ShapeFit fit = least_squares_fit(kind, points);
      ASSERT_EQ(fit.status, FitStatus::ok) << fit.reason;
      Eigen::Matrix<double, 8, 1> off;
      // The noise moves the centroid and with it the point along the axis, which means nothing.
      Shape shape = fit.shape;
      if (kind == ShapeKind::line2 || kind == ShapeKind::line3 || kind == ShapeKind::cylinder ||
          kind == ShapeKind::cone) {
        const double along = (reference.shape.point - shape.point).dot(reference.shape.direction) /
                             shape.direction.dot(reference.shape.direction);
        shape.point += along * shape.direction;
        shape.radius += along * std::tan(shape.half_angle);
      } else if (kind == ShapeKind::plane) {
        const double across =
            (reference.shape.point - shape.point).dot(shape.direction) / shape.direction.dot(reference.shape.direction);
        shape.point = reference.shape.point - across * reference.shape.direction;
      }
      off << shape.point - reference.shape.point, shape.direction - reference.shape.direction,
          shape.radius - reference.shape.radius, shape.half_angle - reference.shape.half_angle;
      scatter += off * off.transpose() / kRuns;
      sigma += fit.sigma / kRuns;
    }
    EXPECT_NEAR(sigma, kSigma, 0.05 * kSigma);
    for (int k = 0; k < 8; ++k) {
      const double expected = std::sqrt(reference.covariance(k, k)), found = std::sqrt(scatter(k, k));
      EXPECT_NEAR(found, expected, 0.15 * expected + 1e-9) << shape_name(kind) << " " << k;
    }
  }
}

TEST(LeastSquaresFit, SaysWhenThePointsDoNotDetermineTheShape) {
  Numbers numbers(6);
  const auto status = [](ShapeKind kind, const Matrix3Xd& points) { return least_squares_fit(kind, points).status; };
  Matrix3Xd line(3, 30), flat(3, 30), circle(3, 40);
  for (Index i = 0; i < 30; ++i) {
    line.col(i) = Vector3d(1, 2, 0) + static_cast<double>(i) * Vector3d(3, 1, 0);
    flat.col(i) << numbers.uniform(-5, 5), numbers.uniform(-5, 5), 0;
  }
  for (Index i = 0; i < 40; ++i) circle.col(i) << 5 * std::cos(0.1 * double(i)), 5 * std::sin(0.1 * double(i)), 1;
  for (const ShapeKind kind : test::all_kinds()) {
    const bool is_line = kind == ShapeKind::line2 || kind == ShapeKind::line3;
    if (!is_line) {
      EXPECT_EQ(status(kind, line), FitStatus::degenerate) << shape_name(kind);
    }
    EXPECT_EQ(status(kind, Matrix3Xd::Constant(3, 20, 4.5)), FitStatus::degenerate) << shape_name(kind);
    EXPECT_EQ(status(kind, Matrix3Xd(3, 0)), FitStatus::too_few_points) << shape_name(kind);
    EXPECT_EQ(status(kind, line.leftCols(1)), FitStatus::too_few_points) << shape_name(kind);
    Matrix3Xd broken = flat;
    broken(1, 7) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(status(kind, broken), FitStatus::bad_points) << shape_name(kind);
  }
  for (const ShapeKind kind : {ShapeKind::sphere, ShapeKind::cylinder, ShapeKind::cone}) {
    EXPECT_EQ(status(kind, flat), FitStatus::degenerate) << shape_name(kind);
    EXPECT_EQ(status(kind, circle), FitStatus::degenerate) << shape_name(kind);
  }
  // A straight line with noise is no circle, however well a huge one fits.
  Matrix3Xd noisy = line;
  for (Index i = 0; i < 30; ++i) noisy.col(i) += 0.01 * Vector3d(numbers.normal(), numbers.normal(), 0);
  EXPECT_NE(status(ShapeKind::circle2, noisy), FitStatus::ok);
  // The corners of a cube are on three cylinders.
  Matrix3Xd cube(3, 8);
  for (int i = 0; i < 8; ++i) cube.col(i) << ((i & 1) != 0 ? 1 : -1), ((i & 2) != 0 ? 1 : -1), ((i & 4) != 0 ? 1 : -1);
  EXPECT_EQ(status(ShapeKind::cylinder, 10 * cube), FitStatus::ambiguous);
  // A round cloud has no best plane.
  Matrix3Xd cross(3, 6);
  cross << Eigen::Matrix3d::Identity(), -Eigen::Matrix3d::Identity();
  EXPECT_EQ(status(ShapeKind::plane, cross), FitStatus::ambiguous);
  EXPECT_EQ(status(ShapeKind::line3, cross), FitStatus::ambiguous);
}

/// Every place of a grid, turned and moved.
Matrix3Xd grid(const Eigen::Array3i& counts, double turn) {
  Matrix3Xd points(3, counts.prod());
  for (Index i = 0; i < points.cols(); ++i) {
    const Index x = i % counts.x(), y = i / counts.x() % counts.y(), z = i / counts.x() / counts.y();
    points.col(i) << static_cast<double>(x), static_cast<double>(y), static_cast<double>(z);
  }
  return (rotation_about(Vector3d::UnitZ(), turn) * points).colwise() + Vector3d(300, -200, 0);
}

TEST(LeastSquaresFit, TheDirectionOfAFullSquareOrCubeIsSaidToBeOpen) {
  // More points than the sample holds that the fit begins with; and so many that they are read on several threads.
  for (const int side : {3, 11, 60, 250}) {
    for (const double turn : {0., 0.3, 0.785}) {
      const ShapeFit square = least_squares_fit(ShapeKind::line2, grid({side, side, 1}, turn));
      EXPECT_EQ(square.status, FitStatus::ambiguous) << side << " " << turn << ": " << square.reason;
      EXPECT_NE(square.reason.find("no direction is better"), std::string::npos) << square.reason;
      EXPECT_FALSE(square.has_covariance);
    }
  }
  for (const ShapeKind kind : {ShapeKind::line3, ShapeKind::plane}) {
    const ShapeFit cube = least_squares_fit(kind, grid({12, 12, 12}, 0.3));
    EXPECT_EQ(cube.status, FitStatus::ambiguous) << shape_name(kind) << ": " << cube.reason;
    EXPECT_NE(cube.reason.find("no direction is better"), std::string::npos) << cube.reason;
  }
  // What a square determines: the line along a direction that is held, and the plane.
  FitOptions held;
  held.constraints.direction = Vector3d(1, 2, 0);
  EXPECT_EQ(least_squares_fit(ShapeKind::line2, grid({11, 11, 1}, 0.3), held).status, FitStatus::ok);
  EXPECT_EQ(least_squares_fit(ShapeKind::plane, grid({11, 11, 2}, 0.3)).status, FitStatus::ok);
}

TEST(LeastSquaresFit, TheLineOfNearlyASquareIsItsPrincipalDirection) {
  // Far more points than the sample, whose own direction is another one.
  const ShapeFit fit = least_squares_fit(ShapeKind::line2, grid({251, 250, 1}, 0.3));
  ASSERT_EQ(fit.status, FitStatus::ok) << fit.reason;
  EXPECT_LT(fit.shape.direction.cross(Vector3d(std::cos(0.3), std::sin(0.3), 0)).norm(), 1e-9);
  const ShapeFit plane = least_squares_fit(ShapeKind::plane, grid({31, 31, 30}, 0.3));
  ASSERT_EQ(plane.status, FitStatus::ok) << plane.reason;
  EXPECT_LT(plane.shape.direction.cross(Vector3d::UnitZ()).norm(), 1e-9);
}

TEST(LeastSquaresFit, AConeOfHeldAngleAboutPointsOfACylinderOpensToEitherSide) {
  Matrix3Xd points(3, 60);
  for (Index i = 0; i < 60; ++i) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(i % 20) / 20;
    const Index circle = i / 20;
    points.col(i) << 5 * std::cos(turn), 5 * std::sin(turn), static_cast<double>(circle);
  }
  FitOptions held;
  held.constraints.direction = Vector3d::UnitZ();
  held.constraints.half_angle = 0.1;
  EXPECT_EQ(least_squares_fit(ShapeKind::cone, points, held).status, FitStatus::ambiguous);
  for (Index i = 0; i < 60; ++i) points.col(i).head<2>() *= 1 + 0.004 * points(2, i);
  EXPECT_EQ(least_squares_fit(ShapeKind::cone, points, held).status, FitStatus::ok);
}

TEST(LeastSquaresFit, SumsOfTheKernelsAreThoseOfTheDerivatives) {
  Numbers numbers(7);
  for (const ShapeKind kind : test::all_kinds()) {
    if (fits::rows_per_point(kind) == 2) continue;  // two residuals; covered by the optimum by construction
    PatchOptions options;
    options.points = 4099;  // more than a block, and no multiple of a vector
    const test::Patch patch = test::patch(kind, options, numbers);
    fits::ShapeFrame frame;
    frame.kind = kind;
    frame.axes = kind == ShapeKind::line2    ? fits::axes_of_line2(patch.shape.direction)
                 : kind == ShapeKind::sphere ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                                             : fits::axes_along(patch.shape.direction);
    frame.origin = patch.shape.point;
    frame.radius = patch.shape.radius;
    frame.half_angle = patch.shape.half_angle;
    const Matrix3Xd points = patch.feet + 0.1 * patch.normals;
    std::vector<double> weights(4099), d(4099);
    for (double& w : weights) w = numbers.uniform(0, 1);
    const fits::NormalSums sums = fits::normal_sums(frame, points, weights, 2);
    fits::distances(frame, points, d, 2);
    fits::Step gradient = fits::Step::Zero();
    Eigen::Matrix<double, 7, 7> matrix = Eigen::Matrix<double, 7, 7>::Zero();
    std::vector<int> free = fits::free_parameters(kind, {});
    for (Index i = 0; i < points.cols(); ++i) {
      fits::Step slope = fits::Step::Zero();
      // Central differences of the plain distance.
      if (i < 50) {
        for (const int k : free) {
          const auto at = [&](double step) {
            fits::Step s = fits::Step::Zero();
            s[k] = step;
            fits::ShapeFrame m = fits::moved(frame, s);
            return fits::point_slopes(m, points.col(i)).distance;
          };
          slope[k] = (at(1e-5) - at(-1e-5)) / 2e-5;
          EXPECT_NEAR(slope[k], fits::point_slopes(frame, points.col(i)).slope[k], 1e-6);
        }
        EXPECT_NEAR(d[static_cast<std::size_t>(i)], 0.1, 1e-12);
        EXPECT_NEAR(distance(patch.shape, points.col(i)), 0.1, 1e-12);
      }
      const fits::PointSlopes exact = fits::point_slopes(frame, points.col(i));
      for (int a = 0; a < 7; ++a) {
        if (std::find(free.begin(), free.end(), a) == free.end()) continue;
        gradient[a] += weights[static_cast<std::size_t>(i)] * exact.slope[a] * exact.distance;
        for (int b = 0; b < 7; ++b) {
          if (std::find(free.begin(), free.end(), b) == free.end()) continue;
          matrix(a, b) += weights[static_cast<std::size_t>(i)] * exact.slope[a] * exact.slope[b];
        }
      }
    }
    EXPECT_LT((gradient - sums.gradient).norm(), 1e-11 * matrix.norm()) << shape_name(kind);
    EXPECT_LT((matrix - sums.matrix).norm(), 1e-12 * matrix.norm()) << shape_name(kind);
  }
}

TEST(LeastSquaresFit, ManyPointsGiveTheSameBitsOnAnyNumberOfThreads) {
  Numbers numbers(8);
  PatchOptions options;
  options.points = 60000;
  options.far = 1e6;
  const test::Patch patch = test::patch(ShapeKind::cylinder, options, numbers);
  const Matrix3Xd points = test::with_orthogonal_residuals(patch, 0.01, numbers);
  FitOptions one, three;
  one.threads = 1;
  three.threads = 3;
  const ShapeFit a = least_squares_fit(ShapeKind::cylinder, points, one),
                 b = least_squares_fit(ShapeKind::cylinder, points, three);
  expect_same(a, patch.shape);
  EXPECT_EQ(a.shape.point, b.shape.point);
  EXPECT_EQ(a.shape.direction, b.shape.direction);
  EXPECT_EQ(a.rms, b.rms);
}

}  // namespace
}  // namespace abbe
