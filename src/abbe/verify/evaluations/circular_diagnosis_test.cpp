#include "abbe/verify/evaluations/circular_diagnosis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

namespace abbe {
namespace {

using std::numbers::pi;
constexpr double kRadius = 150;

struct Causes {
  double centre_first = 0, centre_second = 0, scale_first = 0, scale_second = 0, squareness = 0, reversal_first = 0,
         reversal_second = 0, servo = 0, length = 0;
};

/// Where the machine is when it follows the circle: built from the axes' errors, not from the patterns of the fit.
Eigen::Vector2d actual(const Causes& cause, double angle, double turn) {
  const Eigen::Vector2d command = kRadius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  const Eigen::Vector2d velocity = turn * Eigen::Vector2d(-std::sin(angle), std::cos(angle));
  Eigen::Vector2d axis = command;  // positions of the two axes
  axis.x() += cause.scale_first * command.x() - cause.servo / 2 * velocity.x();
  axis.y() += cause.scale_second * command.y() + cause.servo / 2 * velocity.y();
  // Reversal value: approach in positive direction less approach in negative direction.
  axis.x() += cause.reversal_first / 2 * (velocity.x() > 0 ? 1 : -1);
  axis.y() += cause.reversal_second / 2 * (velocity.y() > 0 ? 1 : -1);
  // The second axis is turned by the squareness error, away from the first one.
  const Eigen::Vector2d second(-std::sin(cause.squareness), std::cos(cause.squareness));
  return Eigen::Vector2d(cause.centre_first, cause.centre_second) + axis.x() * Eigen::Vector2d(1, 0) +
         axis.y() * second;
}

CircularReadings path(const Causes& cause, CircularAngle kind, double turn, double from_deg, double arc_deg,
                      std::size_t n, double noise, std::mt19937_64& random) {
  std::normal_distribution<double> draw(0, 1);
  CircularReadings readings;
  readings.kind = kind;
  for (std::size_t i = 0; i < n; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
    const double angle = (from_deg + arc_deg * (turn > 0 ? share : 1 - share)) * pi / 180;
    const Eigen::Vector2d point = actual(cause, angle, turn);
    readings.angle.push_back(kind == CircularAngle::measured ? std::atan2(point.y(), point.x()) : angle);
    readings.radius.push_back(point.norm() + cause.length + noise * draw(random));
  }
  return readings;
}

const CircularCauseValue& of(const CircularDiagnosis& diagnosis, CircularCause cause) {
  return diagnosis.causes[static_cast<std::size_t>(cause)];
}

const Causes kKnown = {0.02, -0.03, 25e-6, -10e-6, 40e-6, -0.004, 0.002, 0.005, 0};

TEST(CircularDiagnosis, FindsEveryKnownCauseOfASimulatedMachine) {
  std::mt19937_64 random(1);
  for (const CircularAngle kind : {CircularAngle::measured, CircularAngle::commanded}) {
    const CircularDiagnosis d = circular_diagnosis(
        {path(kKnown, kind, -1, 0, 360, 720, 0, random), path(kKnown, kind, 1, 0, 360, 720, 0, random)},
        {.nominal_radius = kRadius});
    ASSERT_EQ(d.status, DiagnosisStatus::done);
    // Second order: products of errors over the radius, below 0.1 um.
    EXPECT_NEAR(of(d, CircularCause::centre_first).value, 0.02, 2e-5);
    EXPECT_NEAR(of(d, CircularCause::centre_second).value, -0.03, 2e-5);
    EXPECT_NEAR(of(d, CircularCause::scale_first).value, 25e-6, 1e-7);
    EXPECT_NEAR(of(d, CircularCause::scale_second).value, -10e-6, 1e-7);
    EXPECT_NEAR(of(d, CircularCause::scale_mismatch).value, 35e-6, 1e-7);
    EXPECT_NEAR(of(d, CircularCause::radius).value, kRadius * 7.5e-6, 1e-5);
    EXPECT_NEAR(of(d, CircularCause::squareness).value, 40e-6, 1e-7);
    EXPECT_NEAR(of(d, CircularCause::reversal_first).value, -0.004, 1e-5);
    EXPECT_NEAR(of(d, CircularCause::reversal_second).value, 0.002, 1e-5);
    EXPECT_NEAR(of(d, CircularCause::servo_mismatch).value, 0.005, 1e-5);
    EXPECT_LT(d.residual_rms, 1e-5);
    // Effects are peak to peak on the path: scale r cos^2, squareness r sin cos.
    EXPECT_NEAR(of(d, CircularCause::scale_first).effect, kRadius * 25e-6, 1e-6);
    EXPECT_NEAR(of(d, CircularCause::squareness).effect, kRadius * 40e-6, 1e-6);
    EXPECT_NEAR(of(d, CircularCause::reversal_first).effect, 0.004, 1e-5);
  }
}

TEST(CircularDiagnosis, ServoMismatchTiltsTheEllipseOppositelyInBothDirections) {
  std::mt19937_64 random(2);
  Causes lag;
  lag.servo = 0.01;
  const std::array<CircularReadings, 2> paths = {path(lag, CircularAngle::commanded, -1, 0, 360, 360, 0, random),
                                                 path(lag, CircularAngle::commanded, 1, 0, 360, 360, 0, random)};
  const CircularDiagnosis both = circular_diagnosis(paths, {.nominal_radius = kRadius});
  EXPECT_NEAR(of(both, CircularCause::servo_mismatch).value, 0.01, 1e-6);
  EXPECT_NEAR(of(both, CircularCause::squareness).value, 0, 1e-8);
  // One direction cannot tell it from a squareness error: neither is given, the others are.
  const CircularDiagnosis one = circular_diagnosis({CircularReadings{}, paths[1]}, {.nominal_radius = kRadius});
  EXPECT_EQ(one.status, DiagnosisStatus::partly_separable);
  EXPECT_FALSE(of(one, CircularCause::servo_mismatch).separable);
  EXPECT_FALSE(of(one, CircularCause::squareness).separable);
  EXPECT_EQ(of(one, CircularCause::squareness).value, 0);
  EXPECT_TRUE(of(one, CircularCause::scale_first).separable);
  EXPECT_TRUE(of(one, CircularCause::reversal_first).separable);
}

TEST(CircularDiagnosis, StandardUncertaintiesAgreeWithRepeatedSimulation) {
  std::mt19937_64 random(3);
  std::array<double, kCircularCauses> error_squares{}, stated_squares{};
  const int repetitions = 300;
  CircularDiagnosis exact;
  for (int k = -1; k < repetitions; ++k) {
    const double noise = k < 0 ? 0 : 5e-4;
    const std::size_t n = 60;
    const CircularDiagnosis d =
        circular_diagnosis({path(kKnown, CircularAngle::measured, -1, 20, 250, n, noise, random),
                            path(kKnown, CircularAngle::measured, 1, 20, 250, n, noise, random)},
                           {.nominal_radius = kRadius});
    if (k < 0) exact = d;
    if (k < 0) continue;
    for (std::size_t j = 0; j < kCircularCauses; ++j) {
      error_squares[j] += std::pow(d.causes[j].value - exact.causes[j].value, 2);
      stated_squares[j] += std::pow(d.causes[j].uncertainty, 2);
    }
  }
  for (std::size_t j = 0; j < kCircularCauses; ++j) {
    ASSERT_TRUE(exact.causes[j].separable) << j;
    EXPECT_NEAR(std::sqrt(stated_squares[j] / error_squares[j]), 1, 0.15) << j;
  }
}

TEST(CircularDiagnosis, ResidualsThatFollowEachOtherMakeTheUncertaintyLarger) {
  std::mt19937_64 random(4);
  std::array<CircularReadings, 2> white, wavy;
  for (std::size_t k = 0; k < 2; ++k) {
    white[k] = path({}, CircularAngle::commanded, k == 0 ? -1 : 1, 0, 360, 1000, 1e-3, random);
    wavy[k] = path({}, CircularAngle::commanded, k == 0 ? -1 : 1, 0, 360, 1000, 0, random);
    // As large as the noise, but a pattern that the causes do not have: seven waves.
    for (std::size_t i = 0; i < 1000; ++i) wavy[k].radius[i] += 1e-3 * std::sqrt(2) * std::cos(7 * wavy[k].angle[i]);
  }
  const CircularDiagnosis noise = circular_diagnosis(white, {.nominal_radius = kRadius});
  const CircularDiagnosis waves = circular_diagnosis(wavy, {.nominal_radius = kRadius});
  EXPECT_NEAR(noise.residual_rms, waves.residual_rms, 5e-5);
  EXPECT_LT(noise.correlation_length, 1.5);
  EXPECT_GT(waves.correlation_length, 20);
  EXPECT_GT(of(waves, CircularCause::squareness).uncertainty, 4 * of(noise, CircularCause::squareness).uncertainty);
}

TEST(CircularDiagnosis, TheOrderOfTheRowsChangesNothing) {
  std::mt19937_64 random(12);
  std::array<CircularReadings, 2> paths = {path(kKnown, CircularAngle::commanded, -1, 0, 360, 180, 1e-4, random),
                                           path(kKnown, CircularAngle::commanded, 1, 0, 360, 180, 1e-4, random)};
  // Residuals that follow each other, so that their order along the path matters.
  for (CircularReadings& readings : paths) {
    for (std::size_t i = 0; i < readings.count(); ++i) readings.radius[i] += 1e-3 * std::cos(7 * readings.angle[i]);
  }
  const CircularDiagnosis in_order = circular_diagnosis(paths, {.nominal_radius = kRadius});
  EXPECT_GT(in_order.correlation_length, 3);
  for (CircularReadings& readings : paths) {
    std::vector<std::size_t> order(readings.count());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), random);
    CircularReadings shuffled = readings;
    for (std::size_t i = 0; i < order.size(); ++i) {
      shuffled.angle[i] = readings.angle[order[i]];
      shuffled.radius[i] = readings.radius[order[i]];
    }
    readings = shuffled;
  }
  const CircularDiagnosis mixed = circular_diagnosis(paths, {.nominal_radius = kRadius});
  EXPECT_NEAR(mixed.correlation_length, in_order.correlation_length, 1e-6);
  for (std::size_t k = 0; k < kCircularCauses; ++k)
    EXPECT_NEAR(mixed.causes[k].uncertainty, in_order.causes[k].uncertainty, 1e-6 * in_order.causes[k].uncertainty);
}

TEST(CircularDiagnosis, AShortArcSaysWhatItCannotTell) {
  std::mt19937_64 random(5);
  const CircularDiagnosis d = circular_diagnosis({path(kKnown, CircularAngle::commanded, -1, 30, 40, 200, 0, random),
                                                  path(kKnown, CircularAngle::commanded, 1, 30, 40, 200, 0, random)},
                                                 {.nominal_radius = kRadius});
  EXPECT_EQ(d.status, DiagnosisStatus::partly_separable);
  for (const CircularCause cause :
       {CircularCause::centre_first, CircularCause::centre_second, CircularCause::radius, CircularCause::scale_mismatch,
        CircularCause::scale_first, CircularCause::squareness}) {
    EXPECT_FALSE(of(d, cause).separable) << static_cast<int>(cause);
    EXPECT_EQ(of(d, cause).value, 0);
    EXPECT_EQ(of(d, cause).uncertainty, 0);
  }
}

TEST(CircularDiagnosis, WithoutCalibratedLengthOnlyTheDifferenceOfTheScalesIsKnown) {
  std::mt19937_64 random(6);
  Causes cause = kKnown;
  cause.length = 0.05;
  const std::array<CircularReadings, 2> paths = {path(cause, CircularAngle::commanded, -1, 0, 360, 360, 0, random),
                                                 path(cause, CircularAngle::commanded, 1, 0, 360, 360, 0, random)};
  const CircularDiagnosis d = circular_diagnosis(paths, {.nominal_radius = kRadius, .length_calibrated = false});
  EXPECT_EQ(d.status, DiagnosisStatus::partly_separable);
  EXPECT_FALSE(of(d, CircularCause::scale_first).separable);
  EXPECT_FALSE(of(d, CircularCause::scale_second).separable);
  EXPECT_NEAR(of(d, CircularCause::scale_mismatch).value, 35e-6, 2e-7);
  // What the length does not know goes into the scales where it is said to be calibrated.
  const CircularDiagnosis stated = circular_diagnosis(paths, {.nominal_radius = kRadius, .length_uncertainty = 0.0015});
  EXPECT_GT(of(stated, CircularCause::scale_first).uncertainty, 1e-5);
  EXPECT_LT(of(stated, CircularCause::scale_mismatch).uncertainty, 1e-6);
}

TEST(CircularDiagnosis, ReadingsNearReversalsCanBeLeftOut) {
  std::mt19937_64 random(8);
  std::array<CircularReadings, 2> paths = {path(kKnown, CircularAngle::commanded, -1, 0, 360, 360, 0, random),
                                           path(kKnown, CircularAngle::commanded, 1, 0, 360, 360, 0, random)};
  for (CircularReadings& readings : paths) {
    for (std::size_t i = 0; i < readings.count(); ++i) {
      if (std::abs(std::remainder(readings.angle[i], pi / 2)) < 0.05) readings.radius[i] += 0.01;
    }
  }
  const CircularDiagnosis spiked = circular_diagnosis(paths, {.nominal_radius = kRadius});
  const CircularDiagnosis d = circular_diagnosis(paths, {.nominal_radius = kRadius, .reversal_margin = 0.06});
  EXPECT_GT(std::abs(of(spiked, CircularCause::radius).value - kRadius * 7.5e-6), 2e-4);
  EXPECT_NEAR(of(d, CircularCause::radius).value, kRadius * 7.5e-6, 2e-5);
  EXPECT_NEAR(of(d, CircularCause::reversal_first).value, -0.004, 2e-5);
  EXPECT_LT(d.residual_rms, 2e-5);
  EXPECT_EQ(d.residuals[0].size(), 360U);
  EXPECT_EQ(circular_diagnosis(paths, {.nominal_radius = kRadius, .reversal_margin = 0.8}).status,
            DiagnosisStatus::too_few_readings);
}

TEST(CircularDiagnosis, FewReadingsAreSaid) {
  std::mt19937_64 random(7);
  const std::array<CircularReadings, 2> paths = {path({}, CircularAngle::commanded, -1, 0, 360, 4, 0, random),
                                                 path({}, CircularAngle::commanded, 1, 0, 360, 4, 0, random)};
  EXPECT_EQ(circular_diagnosis(paths, {.nominal_radius = kRadius}).status, DiagnosisStatus::too_few_readings);
  EXPECT_EQ(circular_diagnosis({}, {.nominal_radius = kRadius}).status, DiagnosisStatus::too_few_readings);
}

}  // namespace
}  // namespace abbe
