#include "abbe/verify/evaluations/rotation_error_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

std::vector<double> turning(std::size_t turns, std::size_t positions, double sense = 1, double from = 0) {
  std::vector<double> angle;
  for (std::size_t i = 0; i < turns * positions; ++i) {
    angle.push_back(from + sense * kTurn * static_cast<double>(i) / static_cast<double>(positions));
  }
  return angle;
}

template <typename Function>
std::vector<double> of(const std::vector<double>& angle, const Function& function) {
  std::vector<double> values;
  for (const double at : angle) values.push_back(function(at));
  return values;
}

const AxisErrorMotion& motion(const RotationResult& result, AxisErrorMotionKind kind) {
  const auto found = std::find_if(result.motions.begin(), result.motions.end(),
                                  [&](const AxisErrorMotion& entry) { return entry.kind == kind; });
  EXPECT_NE(found, result.motions.end());
  return *found;
}

TEST(RotationErrorMotion, EccentricityIsNoErrorMotionAndLobesAre) {
  // Ball 40 um out of centre; the axis itself moves 3 um twice per turn along X.
  RotationReadings readings;
  readings.angle = turning(8, 72);
  readings.x1 = of(readings.angle, [](double a) { return 0.5 + 0.04 * std::cos(a - 0.3) + 0.003 * std::cos(2 * a); });
  readings.y1 = of(readings.angle, [](double a) { return -0.2 + 0.04 * std::sin(a - 0.3); });
  const RotationResult result = rotation_error_motions(readings, {.reading_uncertainty = 1e-5});
  ASSERT_EQ(result.status, RotationStatus::done);
  EXPECT_EQ(result.turns, 8U);
  EXPECT_EQ(result.positions, 72U);
  EXPECT_FALSE(result.interpolated);
  ASSERT_EQ(result.motions.size(), 3U);
  const AxisErrorMotion& x = motion(result, AxisErrorMotionKind::radial_fixed_x1);
  EXPECT_NEAR(x.total_value, 0.006, 1e-12);
  EXPECT_NEAR(x.synchronous_value, 0.006, 1e-12);
  EXPECT_NEAR(x.asynchronous_value, 0, 1e-12);
  EXPECT_NEAR(x.fundamental_value, 0.08, 1e-12);
  EXPECT_NEAR(x.synchronous_uncertainty, 1e-5 * std::sqrt(2.0 / 8), 1e-18);
  EXPECT_NEAR(x.total_uncertainty, 1e-5 * std::sqrt(2.0), 1e-18);
  EXPECT_NEAR(motion(result, AxisErrorMotionKind::radial_fixed_y1).total_value, 0, 1e-12);
  // cos 2a cos a = (cos a + cos 3a)/2, of which the centre takes the first part.
  EXPECT_NEAR(motion(result, AxisErrorMotionKind::radial_rotating_1).synchronous_value, 0.003, 1e-12);
}

TEST(RotationErrorMotion, WhatComesBackEveryOtherTurnIsAsynchronous) {
  RotationReadings readings;
  readings.angle = turning(6, 64);
  readings.axial = of(readings.angle, [](double a) {
    return 7 + 0.002 * std::cos(a + 1) + 0.001 * std::cos(4 * a) + 0.0015 * std::cos(2.5 * a);
  });
  const RotationResult result = rotation_error_motions(readings);
  const AxisErrorMotion& axial = motion(result, AxisErrorMotionKind::axial);
  // Half-odd harmonics change their sign from turn to turn: their mean over an even number of turns is zero.
  EXPECT_NEAR(axial.asynchronous_value, 0.003, 1e-12);
  EXPECT_NEAR(axial.fundamental_value, 0.004, 1e-12);
  EXPECT_NEAR(axial.residual_value, 0.002, 1e-12);
  double low = 1, high = -1;
  for (int k = 0; k < 64; ++k) {
    const double a = kTurn * k / 64, value = 0.002 * std::cos(a + 1) + 0.001 * std::cos(4 * a);
    low = std::min(low, value);
    high = std::max(high, value);
  }
  EXPECT_NEAR(axial.synchronous_value, high - low, 1e-12);
  EXPECT_GT(axial.total_value, axial.synchronous_value);
  EXPECT_NEAR(axial.asynchronous_uncertainty, 0, 0);
}

TEST(RotationErrorMotion, TiltComesFromTwoPlanesAndHasNoEccentricity) {
  RotationReadings readings;
  readings.angle = turning(5, 360);
  const auto wobble = [](double a) { return 20e-6 * std::cos(3 * a); };  // towards X, 20 urad
  readings.x1 = of(readings.angle, [](double a) { return 0.01 * std::cos(a); });
  readings.y1 = of(readings.angle, [](double a) { return 0.01 * std::sin(a); });
  readings.x2 = of(readings.angle, [&](double a) { return 0.03 * std::cos(a + 1) + 80 * wobble(a); });
  readings.y2 = of(readings.angle, [](double a) { return 0.03 * std::sin(a + 1); });
  const RotationResult result = rotation_error_motions(readings, {.plane_distance = 80, .reading_uncertainty = 1e-4});
  ASSERT_EQ(result.motions.size(), 9U);
  const AxisErrorMotion& tilt = motion(result, AxisErrorMotionKind::tilt_fixed_x);
  EXPECT_TRUE(is_tilt(tilt.kind));
  EXPECT_NEAR(tilt.synchronous_value, 40e-6, 1e-12);
  EXPECT_NEAR(tilt.total_uncertainty, 2e-4 / 80, 1e-15);
  EXPECT_NEAR(motion(result, AxisErrorMotionKind::tilt_fixed_y).synchronous_value, 0, 1e-12);
  // cos 3a cos a = (cos 2a + cos 4a)/2: from 1 at 0 to -0.5625 where cos 2a = -1/4.
  EXPECT_NEAR(motion(result, AxisErrorMotionKind::tilt_rotating).synchronous_value, (1 + 0.5625) * 20e-6, 2e-9);
  // Without the distance there is no tilt.
  EXPECT_EQ(rotation_error_motions(readings).motions.size(), 6U);
}

TEST(RotationErrorMotion, DoesNotDependOnSenseStartOrOffset) {
  const auto shape = [](double a) { return 0.004 * std::cos(2 * a) + 0.001 * std::sin(5 * a + 0.4); };
  RotationReadings forward, backward;
  forward.angle = turning(4, 90);
  backward.angle = turning(4, 90, -1, kTurn * 30 / 90 + 20 * kTurn);
  forward.x1 = of(forward.angle, shape);
  forward.y1 = of(forward.angle, [&](double a) { return shape(a + 1); });
  backward.x1 = of(backward.angle, [&](double a) { return 3 + shape(a); });
  backward.y1 = of(backward.angle, [&](double a) { return shape(a + 1) - 2; });
  const RotationResult a = rotation_error_motions(forward), b = rotation_error_motions(backward);
  ASSERT_EQ(a.motions.size(), b.motions.size());
  for (std::size_t i = 0; i < a.motions.size(); ++i) {
    EXPECT_NEAR(a.motions[i].synchronous_value, b.motions[i].synchronous_value, 1e-11) << i;
    EXPECT_NEAR(a.motions[i].total_value, b.motions[i].total_value, 1e-11) << i;
  }
  // A rotating direction a quarter turn ahead sees Y where the other one saw X.
  std::swap(forward.x1, forward.y1);
  for (double& value : forward.x1) value = -value;
  const RotationResult turned = rotation_error_motions(forward, {.sensitive_angle = kTurn / 4});
  EXPECT_NEAR(motion(turned, AxisErrorMotionKind::radial_rotating_1).total_value,
              motion(a, AxisErrorMotionKind::radial_rotating_1).total_value, 1e-12);
}

TEST(RotationErrorMotion, ReadingsAtOtherAnglesInEveryTurnAreInterpolated) {
  RotationReadings readings;
  for (int i = 0; i < 2000; ++i) readings.angle.push_back(kTurn * i / 180.37);
  readings.x1 = of(readings.angle, [](double a) { return 0.02 * std::cos(a) + 0.005 * std::cos(3 * a); });
  const RotationResult result = rotation_error_motions(readings);
  ASSERT_EQ(result.status, RotationStatus::done);
  EXPECT_TRUE(result.interpolated);
  EXPECT_EQ(result.turns, 11U);
  EXPECT_EQ(result.positions, 180U);
  const AxisErrorMotion& x = motion(result, AxisErrorMotionKind::radial_fixed_x1);
  EXPECT_NEAR(x.synchronous_value, 0.01, 1e-5);
  // Linear interpolation leaves step^2/8 of the second derivative, 0.02 + 9 * 0.005 mm per rad^2.
  EXPECT_LT(x.asynchronous_value, 0.065 * std::pow(kTurn / 180, 2) / 8 + 1e-9);
}

TEST(RotationErrorMotion, DriftIsToldApart) {
  RotationReadings readings;
  readings.angle = turning(10, 36);
  for (std::size_t i = 0; i < readings.angle.size(); ++i) {
    const std::size_t turn = i / 36;
    readings.axial.push_back(0.001 * static_cast<double>(turn));
  }
  const AxisErrorMotion axial = rotation_error_motions(readings).motions.at(0);
  EXPECT_NEAR(axial.drift, 0.009, 1e-12);
  EXPECT_NEAR(axial.asynchronous_value, 0.009, 1e-12);
  EXPECT_NEAR(axial.synchronous_value, 0, 1e-12);
}

TEST(RotationErrorMotion, UncertaintiesCoverRepeatedSimulation) {
  // Two bumps of the axis, so that the touching positions do not change with the noise.
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0, 1e-5);
  RotationReadings readings;
  readings.angle = turning(6, 48);
  const auto bump = [](double a) {
    const double k = std::round(48 * std::fmod(a, kTurn) / kTurn);
    return k == 10 ? 0.001 : k == 31 ? -0.001 : 0;
  };
  double mean = 0, squares = 0;
  AxisErrorMotion x;
  const int repetitions = 600;
  for (int r = 0; r < repetitions; ++r) {
    readings.x1 = of(readings.angle, [&](double a) { return bump(a) + noise(random); });
    x = rotation_error_motions(readings, {.reading_uncertainty = 1e-5}).motions.at(0);
    mean += x.synchronous_value / repetitions;
    squares += x.synchronous_value * x.synchronous_value / repetitions;
  }
  EXPECT_NEAR(std::sqrt(squares - mean * mean) / x.synchronous_uncertainty, 1, 0.12);
}

TEST(RotationErrorMotion, FewTurnsFewPositionsAndGapsAreSaid) {
  const auto status = [](std::vector<double> angle) {
    RotationReadings readings;
    readings.angle = std::move(angle);
    readings.x1.assign(readings.angle.size(), 0.0);
    const RotationResult result = rotation_error_motions(readings);
    EXPECT_EQ(result.motions.empty(), result.status != RotationStatus::done);
    return result.status;
  };
  EXPECT_EQ(status({}), RotationStatus::too_few_turns);
  EXPECT_EQ(status({1}), RotationStatus::too_few_turns);
  EXPECT_EQ(status({1, 1, 1}), RotationStatus::too_few_turns);
  EXPECT_EQ(status(turning(3, 90)), RotationStatus::too_few_turns);
  EXPECT_EQ(status(turning(4, 90)), RotationStatus::done);
  std::vector<double> angle = turning(4, 90);
  angle.pop_back();
  EXPECT_EQ(status(angle), RotationStatus::too_few_turns);
  EXPECT_EQ(status(turning(9, 15)), RotationStatus::too_few_positions);
  EXPECT_EQ(status(turning(9, 16)), RotationStatus::done);
  angle = turning(6, 90);
  angle.erase(angle.begin() + 100, angle.begin() + 110);
  EXPECT_EQ(status(angle), RotationStatus::uneven_coverage);
  angle = turning(6, 90);
  std::swap(angle[50], angle[51]);
  EXPECT_EQ(status(angle), RotationStatus::uneven_coverage);
}

}  // namespace
}  // namespace abbe
