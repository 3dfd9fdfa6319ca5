#include "abbe/geometry/fits/coaxial_circles.h"

#include <gtest/gtest.h>

#include <limits>

#include "abbe/geometry/fits/numbers_for_test.h"
#include "abbe/geometry/fits/shape_points_for_test.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::Numbers;

struct Turned {
  Vector3d point, direction;
  std::vector<double> heights = {-30, 5, 25}, radii = {12, 30, 8};
  std::vector<Matrix3Xd> circles;
};

/// Three circles about one axis, arcs of that length, with noise across them.
Turned turned(double far, double arc, double noise, Numbers& numbers) {
  Turned t;
  t.direction = numbers.direction();
  if (t.direction.cwiseAbs().maxCoeff() > t.direction.maxCoeff()) t.direction *= -1;
  t.point = far * numbers.direction();
  const Vector3d u = t.direction.unitOrthogonal(), v = t.direction.cross(u);
  for (std::size_t c = 0; c < 3; ++c) {
    Matrix3Xd circle(3, 60);
    for (Index i = 0; i < circle.cols(); ++i) {
      const double a = arc * static_cast<double>(i) / 60 + static_cast<double>(c);
      const double r = t.radii[c] + noise * numbers.normal(), z = t.heights[c] + noise * numbers.normal();
      circle.col(i) = t.point + z * t.direction + r * (std::cos(a) * u + std::sin(a) * v);
    }
    t.circles.push_back(circle);
  }
  return t;
}

TEST(CoaxialCircles, ExactCirclesGiveTheirAxisAlsoFarAwayAndOnShortArcs) {
  Numbers numbers(31);
  for (const double far : {0.0, 1e6}) {
    for (const double arc : {6.28, 0.6}) {
      const Turned t = turned(far, arc, 0, numbers);
      const CoaxialCircles fit = coaxial_circles_fit(t.circles);
      ASSERT_EQ(fit.status, FitStatus::ok) << fit.reason;
      EXPECT_LT((fit.point - t.point).cross(t.direction).norm(), 1e-7);
      EXPECT_LT(fit.direction.cross(t.direction).norm(), 1e-9);
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(fit.radii[c], t.radii[c], 1e-7);
        EXPECT_LT((fit.centre(c) - t.point - t.heights[c] * t.direction).norm(), 1e-7);
      }
    }
  }
}

TEST(CoaxialCircles, OneCircleIsTheCircleInSpace) {
  Numbers numbers(32);
  const Turned t = turned(100, 2, 0.01, numbers);
  const CoaxialCircles fit = coaxial_circles_fit(std::span(t.circles).first(1));
  const ShapeFit circle = least_squares_fit(ShapeKind::circle3, t.circles[0]);
  ASSERT_TRUE(fit.ok() && circle.ok());
  EXPECT_LT((fit.centre(0) - circle.shape.point).norm(), 1e-9);
  EXPECT_LT((fit.direction - circle.shape.direction).norm(), 1e-11);
  EXPECT_NEAR(fit.radii[0], circle.shape.radius, 1e-9);
  EXPECT_NEAR(fit.sigma, circle.sigma, 1e-12);
  EXPECT_NEAR(std::sqrt(fit.covariance(7, 7)), circle.radius_uncertainty(), 1e-10);
  const Eigen::Matrix3d tilt = fit.covariance.block(3, 3, 3, 3) - circle.covariance.block(3, 3, 3, 3);
  EXPECT_LT(tilt.cwiseAbs().maxCoeff(), 1e-12);
}

/// Sum of squares in plain coordinates, without what the fit uses.
double squares(const CoaxialCircles& fit, const Turned& t) {
  double sum = 0;
  for (std::size_t c = 0; c < t.circles.size(); ++c) {
    Shape circle;
    circle.kind = ShapeKind::circle3;
    circle.point = fit.centre(c);
    circle.direction = fit.direction;
    circle.radius = fit.radii[c];
    for (Index i = 0; i < t.circles[c].cols(); ++i) sum += std::pow(distance(circle, t.circles[c].col(i)), 2);
  }
  return sum;
}

TEST(CoaxialCircles, NoAxisNearbyHasASmallerSum) {
  Numbers numbers(33);
  const Turned t = turned(0, 1.5, 0.05, numbers);
  const CoaxialCircles fit = coaxial_circles_fit(t.circles);
  ASSERT_TRUE(fit.ok()) << fit.reason;
  const double least = squares(fit, t);
  EXPECT_NEAR(fit.rms, std::sqrt(least / 180), 1e-12);
  for (int trial = 0; trial < 2000; ++trial) {
    const double reach = std::pow(10, numbers.uniform(-6, -1));
    CoaxialCircles other = fit;
    other.point += reach * numbers.direction();
    other.direction = (other.direction + 0.05 * reach * numbers.direction()).normalized();
    for (double& r : other.radii) r += reach * numbers.normal();
    for (double& h : other.heights) h += reach * numbers.normal();
    ASSERT_GE(squares(other, t), least * (1 - 1e-12)) << reach;
  }
}

TEST(CoaxialCircles, HoldsDirectionAndRadii) {
  Numbers numbers(34);
  const Turned t = turned(0, 1, 0.01, numbers);
  CoaxialOptions options;
  options.direction = -2 * t.direction;
  options.radii = t.radii;
  const CoaxialCircles fit = coaxial_circles_fit(t.circles, options);
  ASSERT_TRUE(fit.ok()) << fit.reason;
  EXPECT_LT((fit.direction - t.direction).norm(), 1e-14);
  EXPECT_EQ(fit.radii, t.radii);
  EXPECT_EQ(fit.covariance(3, 3), 0);
  EXPECT_EQ(fit.degrees_of_freedom, 360 - 5);
  EXPECT_LT((fit.point - t.point).cross(t.direction).norm(), 0.01);
  const CoaxialCircles free = coaxial_circles_fit(t.circles);
  ASSERT_TRUE(free.ok()) << free.reason;
  EXPECT_GT(free.covariance.topLeftCorner(3, 3).trace(), fit.covariance.topLeftCorner(3, 3).trace());
}

TEST(CoaxialCircles, CovarianceIsTheScatterOfManyFits) {
  Numbers numbers(35);
  const Turned exact = turned(0, 2.5, 0, numbers);
  CoaxialOptions options;
  options.sigma = 0.002;
  const CoaxialCircles reference = coaxial_circles_fit(exact.circles, options);
  ASSERT_TRUE(reference.ok()) << reference.reason;
  constexpr int kRuns = 250;
  Eigen::VectorXd scatter = Eigen::VectorXd::Zero(12);
  for (int run = 0; run < kRuns; ++run) {
    std::vector<Matrix3Xd> circles = exact.circles;
    for (std::size_t c = 0; c < 3; ++c) {
      for (Index i = 0; i < circles[c].cols(); ++i) {
        const Vector3d out = (circles[c].col(i) - reference.centre(c)).normalized();
        circles[c].col(i) += options.sigma * (numbers.normal() * out + numbers.normal() * reference.direction);
      }
    }
    const CoaxialCircles fit = coaxial_circles_fit(circles, options);
    ASSERT_TRUE(fit.ok()) << fit.reason;
    // The point along the axis is the mean of the centres: taken back to the one of the reference.
    const double along = (reference.point - fit.point).dot(fit.direction);
    Eigen::VectorXd off(12);
    off.head<3>() = fit.point + along * fit.direction - reference.point;
    off.segment<3>(3) = fit.direction - reference.direction;
    for (Index c = 0; c < 3; ++c) {
      const auto k = static_cast<std::size_t>(c);
      off[6 + c] = fit.heights[k] - along - reference.heights[k];
      off[9 + c] = fit.radii[k] - reference.radii[k];
    }
    scatter += off.cwiseAbs2() / kRuns;
  }
  for (Index k = 0; k < 12; ++k) {
    const double expected = std::sqrt(reference.covariance(k, k));
    EXPECT_NEAR(std::sqrt(scatter[k]), expected, 0.17 * expected + 1e-9) << k;
  }
}

TEST(CoaxialCircles, SaysWhenThereIsNoAnswer) {
  Numbers numbers(36);
  Turned t = turned(0, 6, 0.01, numbers);
  EXPECT_EQ(coaxial_circles_fit({}).status, FitStatus::too_few_points);
  std::vector<Matrix3Xd> circles = t.circles;
  circles[1] = circles[1].leftCols(1).eval();
  EXPECT_EQ(coaxial_circles_fit(circles).status, FitStatus::too_few_points);
  circles[1] = Matrix3Xd::Constant(3, 9, 2.5);
  EXPECT_EQ(coaxial_circles_fit(circles).status, FitStatus::degenerate);
  circles[1](0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(coaxial_circles_fit(circles).status, FitStatus::bad_points);
  for (Matrix3Xd& circle : circles) {
    circle.resize(3, 20);
    for (Index i = 0; i < 20; ++i) circle.col(i) << static_cast<double>(i), 0, 0;
  }
  EXPECT_NE(coaxial_circles_fit(circles).status, FitStatus::ok);
  CoaxialOptions options;
  options.radii = {1, 2};
  EXPECT_THROW(coaxial_circles_fit(t.circles, options), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
