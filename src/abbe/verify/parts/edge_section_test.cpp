#include "abbe/verify/parts/edge_section.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/instruments/engraved_edge.h"
#include "abbe/instruments/triangulation.h"

namespace abbe {
namespace {

struct Corner {
  Eigen::Vector2d corner;
  double radius, slope, tilt;
  double turn() const { return std::numbers::pi / 2 + slope + tilt; }
};

/// Points on surface, rounding and wall, computed from the corner's bisector: another way than the fit's.
Eigen::Matrix2Xd points_on(const Corner& c, int each, bool with_wall) {
  const Eigen::Vector2d back = -Eigen::Vector2d(std::cos(c.slope), std::sin(c.slope));
  const Eigen::Vector2d down = -Eigen::Vector2d(std::sin(c.tilt), std::cos(c.tilt));
  const Eigen::Vector2d bisector = (back + down).normalized();
  const double half = std::acos(back.dot(bisector));
  const Eigen::Vector2d centre = c.corner + c.radius / std::sin(half) * bisector;
  const double reach = c.radius / std::tan(half);
  Eigen::Matrix2Xd points(2, with_wall ? 3 * each : 2 * each);
  const double from = std::atan2((c.corner + reach * back - centre).y(), (c.corner + reach * back - centre).x());
  for (int i = 0; i < each; ++i) {
    const double t = (i + 0.5) / each;
    points.col(i) = c.corner + (reach + 0.3 * (1 - t)) * back;
    const double a = from - t * c.turn();
    points.col(each + i) = centre + c.radius * Eigen::Vector2d(std::cos(a), std::sin(a));
    if (with_wall) points.col(2 * each + i) = c.corner + (reach + 0.12 * t) * down;
  }
  return points;
}

TEST(EdgeSection, ExactPointsGiveCornerOnsetAndRadius) {
  RandomStream random(1);
  for (int run = 0; run < 8; ++run) {
    const Corner truth = {{random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05)},
                          random.uniform(0.008, 0.04),
                          random.uniform(-0.15, 0.15),
                          random.uniform(-0.2, 0.2)};
    EdgeOptions options;
    options.beam_tilt = truth.tilt;
    for (const bool free : {false, true}) {
      options.free_wall = free;
      if (free) options.beam_tilt = truth.tilt + 0.1;
      const EdgeFit fit = fit_edge(points_on(truth, 80, true), options);
      ASSERT_EQ(fit.status, EdgeStatus::ok) << fit.reason;
      EXPECT_LT((fit.corner - truth.corner).norm(), 1e-8);
      EXPECT_NEAR(fit.radius, truth.radius, 1e-8);
      EXPECT_NEAR(fit.surface_slope, truth.slope, 1e-7);
      EXPECT_NEAR(fit.wall_tilt, truth.tilt, free ? 1e-7 : 0);
      EXPECT_NEAR((fit.corner - fit.onset).norm(), fit.rounding, 1e-12);
      EXPECT_NEAR(fit.rounding, truth.radius * std::tan(truth.turn() / 2), 1e-8);
    }
  }
}

TEST(EdgeSection, TheRoundingAloneGivesTheCornerWhereTheWallIsNotSeen) {
  const Corner truth = {{0.011, -0.004}, 0.02, 0.03, 0.05};
  EdgeOptions options;
  options.beam_tilt = truth.tilt;
  Eigen::Matrix2Xd points = points_on(truth, 80, false);
  // Of the rounding 75 degrees are seen, then the bottom behind a shadow.
  Eigen::Matrix2Xd seen(2, 80 + 66 + 40);
  seen << points.leftCols(146), Eigen::Matrix2Xd::Zero(2, 40);
  for (int i = 0; i < 40; ++i) seen.col(146 + i) << 0.05 + 0.005 * i, -0.15;
  const EdgeFit fit = fit_edge(seen, options);
  ASSERT_EQ(fit.status, EdgeStatus::ok) << fit.reason;
  EXPECT_LT((fit.corner - truth.corner).norm(), 1e-8);
  EXPECT_EQ(fit.on_wall, 0U);
  EXPECT_NEAR(fit.turn_seen, 66 / 80.0 * truth.turn(), 0.03);
}

TEST(EdgeSection, TheOtherSideIsTheMirrorImage) {
  const Corner truth = {{0.02, 0.01}, 0.015, 0.1, -0.05};
  Eigen::Matrix2Xd points = points_on(truth, 60, true);
  EdgeOptions options;
  options.beam_tilt = truth.tilt;
  options.surface_curvature = 1 / 300.0;
  const EdgeFit left = fit_edge(points, options);
  points.row(0) *= -1;
  options.surface = EdgeSide::right;
  options.beam_tilt = -truth.tilt;
  const EdgeFit right = fit_edge(points, options);
  ASSERT_EQ(left.status, EdgeStatus::ok);
  ASSERT_EQ(right.status, EdgeStatus::ok);
  EXPECT_NEAR(right.corner.x(), -left.corner.x(), 1e-10);
  EXPECT_NEAR(right.onset.x(), -left.onset.x(), 1e-10);
  EXPECT_NEAR(right.corner.y(), left.corner.y(), 1e-10);
  EXPECT_NEAR(right.surface_slope, -left.surface_slope, 1e-9);
  EXPECT_NEAR(right.wall_tilt, -left.wall_tilt, 0);
  EXPECT_NEAR(right.rounding, left.rounding, 1e-10);
}

/// A scan of an engraved edge or groove, whose origin is the commanded curve.
Eigen::Matrix2Xd scanned(const EngravedEdge& edge, std::uint64_t seed) {
  LineScanner scanner = LineScanner::published();
  scanner.width = 0.4;
  scanner.points = 394;
  const RayTracer part(engraved_mesh(edge, 0.4, 1));
  RandomStream random(seed);
  return scan_section(scanner, part, {}, random).points;
}

EdgeOptions published_noise() {
  EdgeOptions options;
  options.height_noise = 2e-3;
  options.across_noise = 1e-3;
  return options;
}

TEST(EdgeSection, StatedUncertaintiesAreThoseOfScannedSections) {
  EngravedEdge edge;
  edge.corner = {0.012, 0};
  edge.radius = 0.02;
  edge.beam_tilt = 0.02;
  edge.surface_curvature = 1 / 528.0;
  EdgeOptions options = published_noise();
  options.beam_tilt = edge.beam_tilt;
  options.surface_curvature = edge.surface_curvature;
  constexpr int kRuns = 60;
  double corner_squares = 0, rounding_squares = 0, printed_squares = 0, mean = 0, own_squares = 0;
  int meets = 0;
  for (int run = 0; run < kRuns; ++run) {
    const Eigen::Matrix2Xd points = scanned(edge, static_cast<std::uint64_t>(run));
    const EdgeFit fit = fit_edge(points, options);
    ASSERT_EQ(fit.status, EdgeStatus::ok) << fit.reason;
    const double off = fit.corner.x() - edge.corner.x();
    mean += off / kRuns;
    corner_squares += off * off / (fit.covariance(0, 0) * kRuns);
    const double truth = edge.radius * std::tan((std::numbers::pi / 2 + edge.beam_tilt) / 2);
    const double rounding_off = fit.rounding - truth;
    own_squares += rounding_off * rounding_off / kRuns;
    rounding_squares += rounding_off * rounding_off / (fit.rounding_uncertainty * fit.rounding_uncertainty * kRuns);
    if (!fit.printed.circle_meets_surface) continue;
    ++meets;
    printed_squares += (fit.printed.distance - truth) * (fit.printed.distance - truth);
  }
  // Chi-square of 60 runs: 1 within three times sqrt(2 / 60), and a little for a rounding of 20 noisy points, which is
  // no straight problem.
  EXPECT_NEAR(corner_squares, 1, 0.7);
  EXPECT_NEAR(rounding_squares, 1, 0.7);
  EXPECT_LT(std::abs(mean), 1.2e-3);
  // A circle of its own often does not meet the surface, and where it does the cut is anywhere.
  EXPECT_LT(meets, kRuns);
  ASSERT_GT(meets, 0);
  EXPECT_GT(std::sqrt(printed_squares / meets), 2 * std::sqrt(own_squares));
}

TEST(EdgeSection, ScatterIsThatOfAsManyDegreesOfFreedomAsThereAre) {
  // The same points with their noise stated and taken from their scatter: variances differ by that of the scatter.
  // With a rounding and a wall that is given, a wall that is free, and no rounding: 4, 5 and 3 unknowns.
  constexpr double kNoise = 1e-5;
  RandomStream random(21);
  for (const int unknowns : {4, 5, 3}) {
    const Corner truth = {{0.01, 0}, unknowns == 3 ? 1e-9 : 0.03, 0, 0};
    Eigen::Matrix2Xd points = points_on(truth, 24, true);
    if (unknowns == 3) points << Eigen::Matrix2Xd(points.leftCols(24)), points.rightCols(24), points.rightCols(24);
    // A wall of 0.12 mm, and a bottom at 0.25 mm, which lies beside it.
    const Eigen::Index seen = unknowns == 3 ? 48 : 72;
    Eigen::Matrix2Xd all(2, seen + 12);
    all << points.leftCols(seen), Eigen::Matrix2Xd::Zero(2, 12);
    for (int i = 0; i < 12; ++i) all.col(seen + i) << 0.1 + 0.02 * i, -0.25;
    for (Eigen::Index i = 0; i < all.cols(); ++i) {
      all.col(i) += kNoise * Eigen::Vector2d(random.normal(), random.normal());
    }
    EdgeOptions options;
    options.free_wall = unknowns == 5;
    const EdgeFit scattered = fit_edge(all, options);
    options.across_noise = options.height_noise = 10 * kNoise;  // so large that no scatter enlarges it
    const EdgeFit stated = fit_edge(all, options);
    ASSERT_EQ(scattered.status, EdgeStatus::ok) << scattered.reason;
    ASSERT_EQ(stated.status, EdgeStatus::ok) << stated.reason;
    const double used = static_cast<double>(scattered.on_surface + scattered.on_rounding + scattered.on_wall);
    EXPECT_LE(used, 72);
    const double variance = scattered.noise * scattered.noise * used / (used - unknowns);
    EXPECT_NEAR(scattered.covariance(0, 0) / stated.covariance(0, 0) / (variance / (100 * kNoise * kNoise)), 1, 0.005)
        << unknowns;
  }
}

TEST(EdgeSection, TheRoundingSaysNothingOfTheContourError) {
  EngravedEdge edge;
  edge.radius = 0.015;
  EdgeOptions options = published_noise();
  for (const double off : {0.0, 0.015, -0.03, 0.06}) {
    edge.corner = {off, 0};
    const EdgeFit fit = fit_edge(scanned(edge, 7), options);
    ASSERT_EQ(fit.status, EdgeStatus::ok) << fit.reason;
    EXPECT_NEAR(fit.corner.x(), off, 2e-3);
    EXPECT_NEAR(fit.rounding, 0.015, 4e-3);
  }
}

TEST(EdgeSection, StrayPointsDoNotMoveIt) {
  EngravedEdge edge;
  edge.corner = {-0.01, 0};
  Eigen::Matrix2Xd points = scanned(edge, 11);
  RandomStream random(12);
  const Eigen::Index half = points.cols() / 2;
  for (int i = 0; i < 12; ++i) {
    const auto at = static_cast<Eigen::Index>(random.uniform() * static_cast<double>(half));
    points(1, at) += random.uniform(0.02, 0.06);  // debris on the surface
  }
  const EdgeFit fit = fit_edge(points, published_noise());
  ASSERT_EQ(fit.status, EdgeStatus::ok) << fit.reason;
  EXPECT_NEAR(fit.corner.x(), edge.corner.x(), 3e-3);
  EXPECT_GE(fit.rejected, 8U);
}

TEST(EdgeSection, AGrooveGivesItsMiddleWithoutWhatTheEdgesHaveInCommon) {
  EngravedEdge groove;
  groove.corner = {-0.05 + 0.007, 0};
  groove.groove_width = 0.1;
  groove.depth = 0.06;
  double squares = 0;
  constexpr int kRuns = 30;
  for (int run = 0; run < kRuns; ++run) {
    const GrooveFit fit = fit_groove(scanned(groove, static_cast<std::uint64_t>(run) + 100), published_noise());
    ASSERT_TRUE(fit.ok()) << fit.left.reason << fit.right.reason;
    EXPECT_NEAR(fit.width, 0.1, 5e-3);
    squares += std::pow((fit.middle - 0.007) / fit.middle_uncertainty, 2) / kRuns;
  }
  EXPECT_NEAR(squares, 1, 0.75);
}

TEST(EdgeSection, WhatShowsNoCornerIsRefused) {
  const Corner truth = {{0, 0}, 0.015, 0, 0};
  Eigen::Matrix2Xd points = points_on(truth, 60, true);
  EXPECT_EQ(fit_edge(points.leftCols(15)).status, EdgeStatus::too_few_points);
  EXPECT_EQ(fit_edge(points.leftCols(60)).status, EdgeStatus::no_edge);
  Eigen::Matrix2Xd steep = points;
  const Eigen::Rotation2Dd turn(40 * kDegree);
  steep = turn.toRotationMatrix() * points;
  EXPECT_EQ(fit_edge(steep).status, EdgeStatus::no_surface);
  // Only the bottom behind the surface: neither wall nor rounding.
  Eigen::Matrix2Xd shadow(2, 100);
  for (int i = 0; i < 60; ++i) shadow.col(i) << -0.3 + 0.004 * i, 0;
  for (int i = 0; i < 40; ++i) shadow.col(60 + i) << 0.05 + 0.005 * i, -0.15;
  const EdgeFit nothing = fit_edge(shadow, published_noise());
  EXPECT_EQ(nothing.status, EdgeStatus::undetermined) << nothing.corner.x() << " +- " << nothing.corner_uncertainty();
  points(0, 3) = std::nan("");
  EXPECT_EQ(fit_edge(points).status, EdgeStatus::not_finite);
}

}  // namespace
}  // namespace abbe
