#include "abbe/verify/evaluations/circular.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace abbe {
namespace {

using std::numbers::pi;

/// Lengths at commanded angles: the nominal radius, an eccentricity and a deviation of the angle.
template <typename Deviation>
CircularReadings bar(std::size_t n, double turn, const Eigen::Vector2d& centre, const Deviation& deviation) {
  CircularReadings readings;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = turn * 2 * pi * static_cast<double>(i) / static_cast<double>(n);
    readings.angle.push_back(angle);
    readings.radius.push_back(
        (centre + (150 + deviation(angle)) * Eigen::Vector2d(std::cos(angle), std::sin(angle))).norm());
  }
  return readings;
}

TEST(Circular, ValuesOfAnEllipseAndABiggerCircleAreThoseWorkedByHand) {
  // Clockwise 5 um cos 2a about the nominal radius, counter-clockwise a perfect circle that is 20 um larger.
  const std::array<CircularReadings, 2> paths = {
      bar(360, -1, {0.03, 0.01}, [](double a) { return 0.005 * std::cos(2 * a); }),
      bar(360, 1, {0.03, 0.01}, [](double) { return 0.02; })};
  const CircularResult result =
      circular_deviations(paths, {.nominal_radius = 150, .reading_uncertainty = 0.0005, .length_uncertainty = 0.0003});
  const CircularDeviation &cw = result.paths[0], &ccw = result.paths[1];
  ASSERT_EQ(cw.status, CircleStatus::done);
  EXPECT_FALSE(cw.partial);
  EXPECT_NEAR(cw.circular, 0.010, 1e-9);
  EXPECT_NEAR(cw.radial_largest, 0.005, 1e-9);
  EXPECT_NEAR(cw.radial_smallest, -0.005, 1e-9);
  EXPECT_NEAR(cw.centre.x(), 0.03, 1e-9);
  EXPECT_NEAR(ccw.circular, 0, 1e-9);
  EXPECT_NEAR(ccw.radial_smallest, 0.020, 1e-9);
  EXPECT_NEAR(result.both.circular, 0.025, 1e-9);
  ASSERT_TRUE(result.has_mean);
  EXPECT_NEAR(result.mean, 0.010, 1e-9);
  // Two readings 90 degrees apart about a centre of 360 readings, each coordinate with variance 2/n.
  EXPECT_NEAR(cw.circular_uncertainty, 0.0005 * std::sqrt(2 - 2 * 2.0 / 360), 2e-9);
  EXPECT_NEAR(result.mean_uncertainty, std::sqrt(9e-8 + 25e-8 / 2 / 360), 1e-9);
}

TEST(Circular, TheInstrumentsCentreLeavesTheSetUpInTheResult) {
  const std::array<CircularReadings, 2> paths = {CircularReadings{}, bar(360, 1, {0.03, 0}, [](double) { return 0; })};
  const CircularResult result = circular_deviations(
      paths, {.nominal_radius = 150, .centre = CircularCentre::instrument, .reading_uncertainty = 1});
  EXPECT_EQ(result.paths[0].status, CircleStatus::not_run);
  EXPECT_NEAR(result.paths[1].circular, 0.06, 1e-12);
  EXPECT_NEAR(result.paths[1].circular_uncertainty, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(result.paths[1].radial_largest_uncertainty, 1, 1e-12);
  EXPECT_EQ(result.both.status, CircleStatus::not_run);
  EXPECT_FALSE(result.has_mean);
}

TEST(Circular, AShortArcHasRadialButNoCircularDeviationAboutAFittedCentre) {
  std::array<CircularReadings, 2> paths;
  for (int i = 0; i <= 90; ++i) {
    paths[1].angle.push_back(i * pi / 180);
    paths[1].radius.push_back(150 + 0.001 * i / 90);
  }
  CircularOptions options{.nominal_radius = 150};
  EXPECT_EQ(circular_deviations(paths, options).paths[1].status, CircleStatus::arc_too_short);
  EXPECT_EQ(circular_deviations(paths, options).paths[1].circular, 0);
  options.centre = CircularCentre::instrument;
  const CircularDeviation arc = circular_deviations(paths, options).paths[1];
  ASSERT_EQ(arc.status, CircleStatus::done);
  EXPECT_TRUE(arc.partial);
  EXPECT_NEAR(arc.radial_largest, 0.001, 1e-12);
}

TEST(Circular, UncertaintiesAgreeWithRepeatedSimulation) {
  // Two clear bumps, so that the touching readings do not change with the noise; few readings, so that the centre
  // counts.
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0, 2e-4);
  const auto bumps = [](double a) { return std::abs(a - pi / 3) < 0.1 ? 0.01 : std::abs(a - pi) < 0.1 ? -0.01 : 0; };
  const CircularReadings exact = bar(12, 1, {0, 0}, bumps);
  double g = 0, g_squares = 0, f = 0, f_squares = 0;
  CircularDeviation stated;
  const int repetitions = 4000;
  for (int k = 0; k < repetitions; ++k) {
    CircularReadings readings = exact;
    for (double& radius : readings.radius) radius += noise(random);
    const CircularResult result =
        circular_deviations({CircularReadings{}, readings}, {.nominal_radius = 150, .reading_uncertainty = 2e-4});
    stated = result.paths[1];
    g += stated.circular / repetitions;
    g_squares += stated.circular * stated.circular / repetitions;
    f += stated.radial_largest / repetitions;
    f_squares += stated.radial_largest * stated.radial_largest / repetitions;
  }
  EXPECT_NEAR(std::sqrt(g_squares - g * g) / stated.circular_uncertainty, 1, 0.05);
  EXPECT_NEAR(std::sqrt(f_squares - f * f) / stated.radial_largest_uncertainty, 1, 0.05);
}

TEST(Circular, ValuesDoNotDependOnWhereTheBarStandsOrWhereThePathStarts) {
  const auto shape = [](double a) { return 0.004 * std::cos(2 * a + 0.4) + 0.002 * std::sin(5 * a); };
  for (const CircularCentre centre : {CircularCentre::least_squares, CircularCentre::minimum_zone}) {
    const CircularOptions options{.nominal_radius = 150, .centre = centre};
    CircularReadings readings = bar(200, 1, {0, 0}, shape);
    const CircularDeviation plain = circular_deviations({CircularReadings{}, readings}, options).paths[1];
    readings = bar(200, 1, {0.4, -0.3}, shape);
    std::rotate(readings.angle.begin(), readings.angle.begin() + 70, readings.angle.end());
    std::rotate(readings.radius.begin(), readings.radius.begin() + 70, readings.radius.end());
    const CircularDeviation moved = circular_deviations({CircularReadings{}, readings}, options).paths[1];
    EXPECT_NEAR(moved.circular, plain.circular, 1e-9);
    EXPECT_NEAR(moved.radial_largest, plain.radial_largest, 1e-8);
  }
}

}  // namespace
}  // namespace abbe
