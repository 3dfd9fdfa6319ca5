#include "abbe/verify/parts/contour_error.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "abbe/errors/random_stream.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

Eigen::Matrix3Xd circle(double radius, double from, double to, int count) {
  Eigen::Matrix3Xd points(3, count);
  for (int i = 0; i < count; ++i) {
    const double a = from + (to - from) * i / (count - 1);
    points.col(i) << radius * std::cos(a), radius * std::sin(a), 7;
  }
  return points;
}

TEST(ContourError, BetweenPointsOfACircleTheCurveIsTheCircle) {
  // Sides of 4 mm on a radius of 528 mm, where chords are 3.8 um off.
  const double step = 4 / 528.0;
  const CommandCurve curve(circle(528, 0.1, 0.1 + 20 * step, 21));
  EXPECT_NEAR(curve.length(), 80, 1e-10);
  RandomStream random(1);
  for (int i = 0; i < 50; ++i) {
    const double angle = random.uniform(0.1, 0.1 + 20 * step), off = random.uniform(-0.05, 0.05);
    const Vector3d p((528 + off) * std::cos(angle), (528 + off) * std::sin(angle), 7);
    const CommandCurve::Foot foot = curve.nearest(p);
    EXPECT_NEAR(foot.distance, std::abs(off), 1e-10);
    EXPECT_NEAR(foot.along, (angle - 0.1) * 528, 1e-9);
    EXPECT_NEAR(foot.tangent.dot(Vector3d(-std::sin(angle), std::cos(angle), 0)), 1, 1e-12);
    EXPECT_FALSE(foot.beyond_end);
  }
  // Coarser pieces as the header says: 2e-5 R turn^6.
  const CommandCurve coarse(circle(100, 0, 2, 6), false, 0.5);
  for (int i = 0; i < 50; ++i) {
    const double angle = random.uniform(0, 2);
    const double off = coarse.nearest({100 * std::cos(angle), 100 * std::sin(angle), 7}).distance;
    EXPECT_LT(off, 2e-5 * 100 * std::pow(0.4, 6));
  }
}

TEST(ContourError, CornersStaySharpAndClosedCurvesClose) {
  Eigen::Matrix3Xd square(3, 8);
  square << 0, 5, 10, 10, 10, 5, 0, 0, 0, 0, 0, 5, 10, 10, 10, 5, 1, 1, 1, 1, 1, 1, 1, 1;
  const CommandCurve curve(square, true);
  EXPECT_NEAR(curve.length(), 40, 1e-12);
  EXPECT_NEAR(curve.nearest({12, 13, 1}).distance, std::hypot(2, 3), 1e-12);
  EXPECT_NEAR(curve.nearest({12, 13, 1}).along, 20, 1e-9);
  EXPECT_NEAR(curve.nearest({-0.25, 2.5, 1}).distance, 0.25, 1e-12);  // on the side that closes it
  EXPECT_NEAR(curve.nearest({-0.25, 2.5, 1}).along, 37.5, 1e-9);
  EXPECT_FALSE(curve.nearest({-1, -1, 1}).beyond_end);
  const CommandCurve open(square);
  EXPECT_TRUE(open.nearest({-0.5, 0, 1}).beyond_end);
  EXPECT_FALSE(open.nearest({2, -1, 1}).beyond_end);
  EXPECT_THROW(CommandCurve(square.leftCols(1)), std::invalid_argument);
  square.col(3) = square.col(2);
  EXPECT_THROW(CommandCurve(square, false), std::invalid_argument);
}

TEST(ContourError, NearestIsTheNearestOfAllPlacesOfAWindingCurve) {
  Eigen::Matrix3Xd points(3, 40);
  for (int i = 0; i < 40; ++i) points.col(i) << 3 * std::cos(0.35 * i), 3 * std::sin(0.35 * i), 0.2 * i;
  const CommandCurve curve(points, false, 1);
  RandomStream random(2);
  // By brute force over the same curve: the feet of points on it.
  std::vector<Vector3d> places;
  for (int i = 0; i < 4000; ++i) {
    const double t = 39.0 * i / 3999;
    const Vector3d exact(3 * std::cos(0.35 * t), 3 * std::sin(0.35 * t), 0.2 * t);
    places.push_back(curve.nearest(exact).point);
    EXPECT_LT((places.back() - exact).norm(), 2e-3);
  }
  for (int i = 0; i < 60; ++i) {
    const Vector3d p(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-1, 9));
    double brute = HUGE_VAL;
    for (const Vector3d& place : places) brute = std::min(brute, (place - p).norm());
    const double found = curve.nearest(p).distance;
    EXPECT_LE(found, brute + 1e-12);
    EXPECT_GT(found, brute - 1e-3);
  }
}

/// Unit vectors from the axis of a circle to its points.
Eigen::Matrix3Xd outwards(const Eigen::Matrix3Xd& points) {
  Eigen::Matrix3Xd out = points;
  out.row(2).setZero();
  out.colwise().normalize();
  return out;
}

TEST(ContourError, DeviationsAreSplitIntoAcrossAndOutOfTheSurface) {
  // Twelve points on the whole circle: their own normals are up to 15 degrees off that of a place between them.
  const Eigen::Matrix3Xd around = circle(50, 0, 2 * std::numbers::pi * 11 / 12, 12);
  const std::vector<CommandPiece> pieces = {{CommandCurve(around, true, 1), 3 * outwards(around)}};
  RandomStream random(4);
  for (int i = 0; i < 30; ++i) {
    const double a = random.uniform(0, 2 * std::numbers::pi);
    const Vector3d out(std::cos(a), std::sin(a), 0);
    // Seen from outside, along the curve, left is n x t = +z.
    const Vector3d place = pieces[0].curve.nearest(50 * out + Vector3d(0, 0, 7)).point;
    const Eigen::Matrix3Xd point = place + Vector3d(0, 0, 0.02) + 0.005 * out;
    const ContourDeviation d = contour_deviations(pieces, point).at(0);
    ASSERT_TRUE(d.across && d.off);
    EXPECT_NEAR(*d.across, 0.02, 1e-6);
    EXPECT_NEAR(*d.off, 0.005, 1e-5);
    EXPECT_NEAR(d.distance, std::hypot(0.02, 0.005), 1e-5);
    EXPECT_NEAR(d.along, 50 * a, 0.02);
  }
}

TEST(ContourError, WithoutANormalNothingIsAcross) {
  const Eigen::Matrix3Xd around = circle(50, 0, 1, 41);
  const Eigen::Matrix3Xd point = Vector3d(50.01 * std::cos(0.5), 50.01 * std::sin(0.5), 7.02);
  const auto deviation = [&](const Eigen::Matrix3Xd& normals) {
    return contour_deviations(std::vector<CommandPiece>{{CommandCurve(around), normals}}, point).at(0);
  };
  const ContourDeviation bare = deviation({});
  EXPECT_FALSE(bare.across || bare.off);
  EXPECT_NEAR(bare.distance, std::hypot(0.01, 0.02), 1e-9);
  // A tool that points along the curve says nothing of the surface.
  Eigen::Matrix3Xd along = outwards(around);
  for (Eigen::Index i = 0; i < along.cols(); ++i) along.col(i) = Vector3d::UnitZ().cross(Vector3d(along.col(i)));
  EXPECT_FALSE(deviation(along).across);
  EXPECT_TRUE(deviation(outwards(around)).across);
  // Normals for some of the points only are a mistake.
  EXPECT_THROW(deviation(outwards(around).leftCols(40)), std::invalid_argument);
  EXPECT_THROW(contour_deviations({}, point), std::invalid_argument);
}

TEST(ContourError, EachPointIsComparedWithThePieceNearestToIt) {
  Eigen::Matrix3Xd first(3, 2), second(3, 2), up(3, 2), points(3, 4);
  first << 0, 10, 0, 0, 0, 0;
  second << 0, 10, 5, 5, 0, 0;
  up << 0, 0, 0, 0, 1, 1;
  const std::vector<CommandPiece> pieces = {{CommandCurve(first), up}, {CommandCurve(second), up}};
  points << 4, 4, 10, 12, 0.01, 4.98, 2.4, 5, 0, 0, 0, 0;
  const std::vector<ContourDeviation> d = contour_deviations(pieces, points);
  EXPECT_EQ(d[0].piece, 0U);
  EXPECT_NEAR(*d[0].across, 0.01, 1e-12);
  EXPECT_EQ(d[1].piece, 1U);
  EXPECT_NEAR(*d[1].across, -0.02, 1e-12);
  EXPECT_NEAR(d[1].along, 14, 1e-12);
  EXPECT_NEAR(*d[2].across, 2.4, 1e-12);  // of the way from one to the other nothing is engraved
  EXPECT_FALSE(d[2].beyond_end);
  EXPECT_TRUE(d[3].beyond_end);
}

TEST(ContourError, FiguresHaveTheUncertaintyOfRepeatedMeasurements) {
  const std::vector<double> truth = {0.012, -0.02, 0.018, 0.025, -0.011, 0.016};
  const std::vector<double> u = {0.3e-3, 0.15e-3, 0.3e-3, 0.24e-3, 0.12e-3, 0.3e-3};
  constexpr double kCommon = 0.2e-3;
  const ContourFigures stated = contour_figures(truth, u, kCommon);
  EXPECT_NEAR(stated.amounts.mean, 0.017, 1e-15);
  EXPECT_NEAR(stated.amounts.maximum, 0.025, 1e-15);
  RandomStream random(5);
  EXPECT_NEAR(stated.bias, (0.012 - 0.02 + 0.018 + 0.025 - 0.011 + 0.016) / 6, 1e-15);
  double mean = 0, largest = 0, deviation = 0, bias = 0;
  constexpr int kRuns = 4000;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<double> measured = truth;
    const double shift = kCommon * random.normal();
    for (std::size_t i = 0; i < u.size(); ++i) measured[i] += shift + u[i] * random.normal();
    const ContourFigures figures = contour_figures(measured);
    const SampleStatistics& s = figures.amounts;
    bias += std::pow(figures.bias - stated.bias, 2) / kRuns;
    mean += std::pow(s.mean - stated.amounts.mean, 2) / kRuns;
    largest += std::pow(s.maximum - stated.amounts.maximum, 2) / kRuns;
    deviation += std::pow(s.deviation - stated.amounts.deviation, 2) / kRuns;
  }
  // Standard deviations of 4000 runs: 1.1 %.
  EXPECT_NEAR(std::sqrt(mean) / stated.mean_uncertainty, 1, 0.04);
  EXPECT_NEAR(std::sqrt(largest) / stated.largest_uncertainty, 1, 0.04);
  EXPECT_NEAR(std::sqrt(deviation) / stated.deviation_uncertainty, 1, 0.04);
  EXPECT_NEAR(std::sqrt(bias) / stated.bias_uncertainty, 1, 0.04);
  EXPECT_EQ(contour_figures({}).amounts.count, 0U);
}

}  // namespace
}  // namespace abbe
