#include "abbe/verify/evaluations/circle_centre.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

/// A path with deviations around a centre: as points, or as lengths at commanded angles.
CircularReadings path(CircularAngle kind, const Eigen::Vector2d& centre, double radius,
                      const std::vector<double>& angles, const std::vector<double>& deviations) {
  CircularReadings readings;
  readings.kind = kind;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const Eigen::Vector2d point =
        centre + (radius + deviations[i]) * Eigen::Vector2d(std::cos(angles[i]), std::sin(angles[i]));
    readings.angle.push_back(kind == CircularAngle::measured ? std::atan2(point.y(), point.x()) : angles[i]);
    readings.radius.push_back(point.norm());
  }
  return readings;
}

std::vector<double> turn(std::size_t n, double from = 0, double arc = 2 * std::numbers::pi) {
  std::vector<double> angles;
  for (std::size_t i = 0; i < n; ++i) angles.push_back(from + arc * static_cast<double>(i) / static_cast<double>(n));
  return angles;
}

double separation(const CircularReadings& readings, const Eigen::Vector2d& centre) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t i = 0; i < readings.count(); ++i) {
    const double radius = radius_about(readings, i, centre);
    low = std::min(low, radius);
    high = std::max(high, radius);
  }
  return high - low;
}

/// Independent route to the minimum zone: golden sections within golden sections.
template <typename Function>
double smallest(const Function& function, double from, double to) {
  constexpr double kGolden = 0.6180339887498949;
  double a = to - kGolden * (to - from), b = from + kGolden * (to - from), fa = function(a), fb = function(b);
  for (int i = 0; i < 50; ++i) {
    if (fa < fb) {
      to = b, b = a, fb = fa, a = to - kGolden * (to - from), fa = function(a);
    } else {
      from = a, a = b, fa = fb, b = from + kGolden * (to - from), fb = function(b);
    }
  }
  return std::min(fa, fb);
}

TEST(CircleCentre, LeastSquaresFindsAnOffsetCircleExactlyFromPointsAndFromLengths) {
  const std::vector<double> angles = turn(73), none(73, 0.0);
  for (const CircularAngle kind : {CircularAngle::measured, CircularAngle::commanded}) {
    // An eccentricity of 3 mm, far beyond a real set-up: a first-order centre would be 45 um out of round.
    const CircularReadings readings = path(kind, {3, -1}, 100, angles, none);
    const CircleCentre circle = least_squares_circle(readings);
    ASSERT_EQ(circle.status, CircleStatus::done);
    EXPECT_NEAR((circle.centre - Eigen::Vector2d(3, -1)).norm(), 0, 1e-11);
    EXPECT_NEAR(circle.radius, 100, 1e-11);
    EXPECT_NEAR(separation(readings, circle.centre), 0, 1e-11);
  }
}

TEST(CircleCentre, PointsAboutTheCentreAreTheTrueOnes) {
  const std::vector<double> angles = turn(16);
  std::vector<double> deviations;
  for (const double angle : angles) deviations.push_back(0.01 * std::cos(2 * angle));
  const CircularReadings lengths = path(CircularAngle::commanded, {0.7, 0.4}, 100, angles, deviations);
  const CircularReadings points = path(CircularAngle::measured, {0.7, 0.4}, 100, angles, deviations);
  const CircularReadings found = points_about(lengths, least_squares_circle(lengths).centre);
  EXPECT_EQ(found.kind, CircularAngle::measured);
  for (std::size_t i = 0; i < angles.size(); ++i) {
    EXPECT_NEAR(std::remainder(found.angle[i] - points.angle[i], 2 * std::numbers::pi), 0, 1e-12);
    EXPECT_NEAR(found.radius[i], points.radius[i], 1e-11);
  }
}

TEST(CircleCentre, LeastSquaresIsStationaryUnderShifts) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise(0, 0.02);
  std::vector<double> deviations;
  for (int i = 0; i < 50; ++i) deviations.push_back(noise(random));
  for (const CircularAngle kind : {CircularAngle::measured, CircularAngle::commanded}) {
    CircularReadings readings = path(kind, {0.5, 0.2}, 50, turn(50, 0.3), deviations);
    const CircleCentre circle = least_squares_circle(readings);
    readings = points_about(readings, circle.centre);
    const auto squares = [&](const Eigen::Vector2d& centre) {
      double mean = 0, sum = 0;
      for (std::size_t i = 0; i < 50; ++i) mean += radius_about(readings, i, centre) / 50;
      for (std::size_t i = 0; i < 50; ++i) sum += std::pow(radius_about(readings, i, centre) - mean, 2);
      return sum;
    };
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector2d step = 1e-4 * Eigen::Vector2d(std::cos(k), std::sin(k));
      EXPECT_GT(squares(circle.centre + step), squares(circle.centre));
      EXPECT_NEAR(squares(circle.centre + step), squares(circle.centre - step), 1e-8);
    }
  }
}

TEST(CircleCentre, CofactorAgreesWithRepeatedSimulation) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 1e-3);
  const std::vector<double> angles = turn(24, 0, 230 * kDegree);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero(), cofactor = sum;
  const int repetitions = 4000;
  for (int k = 0; k < repetitions; ++k) {
    std::vector<double> deviations(angles.size());
    for (double& value : deviations) value = noise(random);
    const CircleCentre circle = least_squares_circle(path(CircularAngle::measured, {0, 0}, 80, angles, deviations));
    const Eigen::Vector3d error(circle.centre.x(), circle.centre.y(), circle.radius - 80);
    sum += error * error.transpose() / (repetitions * 1e-6);
    cofactor = circle.cofactor;
  }
  for (Eigen::Index i = 0; i < 3; ++i) EXPECT_NEAR(std::sqrt(sum(i, i) / cofactor(i, i)), 1, 0.05);
  EXPECT_NEAR(sum(0, 2) / cofactor(0, 2), 1, 0.15);
}

TEST(CircleCentre, MinimumZoneIsTheSmallestSeparationThereIs) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> noise(0, 0.01);
  std::uniform_real_distribution<double> jitter(-0.5, 0.5);
  for (int repetition = 0; repetition < 30; ++repetition) {
    const std::size_t n = 5 + static_cast<std::size_t>(repetition);
    const bool repeats = repetition % 3 == 0;  // two readings at every angle
    std::vector<double> angles = turn(n), deviations;
    for (double& angle : angles) angle += jitter(random) / static_cast<double>(n);
    if (repeats) {
      const std::vector<double> once = angles;
      angles.insert(angles.end(), once.begin(), once.end());
    }
    for (std::size_t i = 0; i < angles.size(); ++i) deviations.push_back(noise(random));
    const CircularAngle kind = repetition % 2 == 0 ? CircularAngle::measured : CircularAngle::commanded;
    CircularReadings readings = path(kind, {0.2, -0.1}, 30, angles, deviations);
    readings = points_about(readings, least_squares_circle(readings).centre);
    const CircleCentre zone = minimum_zone_circle(readings);
    ASSERT_EQ(zone.status, CircleStatus::done) << repetition;
    const double searched = smallest(
        [&](double x) {
          return smallest([&](double y) { return separation(readings, {x, y}); }, -0.3, 0.1);
        },
        0.0, 0.4);
    EXPECT_NEAR(separation(readings, zone.centre), searched, 2e-9) << repetition;
    EXPECT_LE(separation(readings, zone.centre), searched + 1e-10) << repetition;
    EXPECT_LE(searched, separation(readings, least_squares_circle(readings).centre) + 1e-12);
  }
}

TEST(CircleCentre, MinimumZoneOfThreeLobesIsWorkedOutByHand) {
  // cos 3a is not changed by any centre: the separation of three lobes is twice their amplitude about the middle.
  std::vector<double> angles = turn(360), deviations;
  for (const double angle : angles) deviations.push_back(0.004 * std::cos(3 * angle));
  const CircleCentre zone = minimum_zone_circle(path(CircularAngle::measured, {0.02, 0.03}, 100, angles, deviations));
  ASSERT_EQ(zone.status, CircleStatus::done);
  EXPECT_NEAR(zone.centre.x(), 0.02, 1e-6);
  EXPECT_NEAR(zone.centre.y(), 0.03, 1e-6);
}

TEST(CircleCentre, TurningTheReadingsTurnsTheCentre) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> noise(0, 0.01);
  std::vector<double> deviations;
  for (int i = 0; i < 40; ++i) deviations.push_back(noise(random));
  CircularReadings readings = path(CircularAngle::measured, {0.2, 0}, 100, turn(40), deviations);
  const CircleCentre ls = least_squares_circle(readings), zone = minimum_zone_circle(readings);
  for (double& angle : readings.angle) angle += 1.1 + 40 * std::numbers::pi;
  const Eigen::Rotation2Dd turned(1.1);
  EXPECT_NEAR((least_squares_circle(readings).centre - turned * ls.centre).norm(), 0, 1e-10);
  EXPECT_NEAR((minimum_zone_circle(readings).centre - turned * zone.centre).norm(), 0, 1e-8);
}

TEST(CircleCentre, ArcsTooShortAndNoCirclesAreSaid) {
  const std::vector<double> none(40, 0.0);
  EXPECT_EQ(least_squares_circle(path(CircularAngle::measured, {0, 0}, 100, turn(40, 0, 210 * kDegree), none)).status,
            CircleStatus::done);
  for (const double arc : {30.0, 90.0, 180.0}) {
    const CircularReadings readings = path(CircularAngle::measured, {0, 0}, 100, turn(40, 1, arc * kDegree), none);
    EXPECT_EQ(least_squares_circle(readings).status, CircleStatus::arc_too_short) << arc;
    EXPECT_EQ(minimum_zone_circle(readings).status, CircleStatus::arc_too_short) << arc;
  }
  CircularReadings two;
  two.angle = {0, 3}, two.radius = {1, 1};
  EXPECT_EQ(least_squares_circle(two).status, CircleStatus::too_few_readings);
  // Lengths that no circle about a near centre can have.
  CircularReadings wild;
  for (const double angle : turn(12)) {
    wild.angle.push_back(angle);
    wild.radius.push_back(angle < 1 ? 1e6 : 1);
  }
  const CircleCentre centre = least_squares_circle(wild);
  EXPECT_EQ(centre.status, CircleStatus::not_converged);
  EXPECT_EQ(centre.centre, Eigen::Vector2d::Zero());
}

}  // namespace
}  // namespace abbe
