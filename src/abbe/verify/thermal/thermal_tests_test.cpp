// Environmental temperature variation error, and distortion by spindles and axes.
#include <gtest/gtest.h>

#include <cmath>

#include "abbe/verify/thermal/axis_distortion.h"
#include "abbe/verify/thermal/etve.h"
#include "abbe/verify/thermal/spindle_distortion.h"

namespace abbe {
namespace {

/// Two sensors along X, 100 mm apart, along Y, and a temperature, every 10 min for 2 h.
ThermalReadings two_planes() {
  ThermalReadings readings;
  const auto add = [](const char* name, double per_hour, std::vector<TimeSeries>& to) {
    TimeSeries series{name, {}, {}};
    for (int i = 0; i <= 12; ++i) {
      series.time.push_back(600 * i);
      series.values.push_back(0.001 + per_hour * i / 6);
    }
    to.push_back(series);
  };
  add("X1", 0.002, readings.displacements);
  add("Y1", 0.001, readings.displacements);
  add("X2", 0.005, readings.displacements);
  add("Y2", -0.001, readings.displacements);
  add("air", 0.8, readings.temperatures);
  return readings;
}

TEST(Etve, FiguresOfASteadyDriftByHand) {
  const EtveEvaluation found = evaluate_etve(two_planes(), {1e-4, 0, 0.05}, 100);
  ASSERT_EQ(found.sensors.size(), 6U);
  EXPECT_NEAR(found.sensors[0].etve.value, 0.004, 1e-12);
  EXPECT_NEAR(found.sensors[0].hourly.value, 0.002, 1e-12);
  EXPECT_NEAR(found.sensors[0].etve.uncertainty, std::sqrt(2) * 1e-4, 1e-12);
  EXPECT_NEAR(found.largest_displacement(), 0.010, 1e-12);
  EXPECT_NEAR(found.temperatures[0].variation.value, 1.6, 1e-12);
  EXPECT_NEAR(found.temperatures[0].rate.value, 0.8, 1e-12);
  EXPECT_NEAR(found.mean_temperature(), 0.801, 1e-12);
  EXPECT_EQ(found.duration(), 7200);
}

/// A rotation about Y by +B moves a point at +Z towards +X, one about X by +A moves it towards -Y.
TEST(ThermalSensors, TiltsHaveTheSignsOfRotationsAboutTheAxes) {
  const std::vector<ThermalSensor> sensors = thermal_sensors(two_planes(), {1e-4, 0, 0}, 100);
  ASSERT_EQ(sensors.size(), 6U);
  EXPECT_EQ(sensors[4].series.name, "A");
  EXPECT_NEAR(sensors[4].series.values.back() - sensors[4].series.values.front(), 0.004 / 100, 1e-12);
  EXPECT_EQ(sensors[5].series.name, "B");
  EXPECT_NEAR(sensors[5].series.values.back() - sensors[5].series.values.front(), 0.006 / 100, 1e-12);
  EXPECT_TRUE(sensors[5].is_angle);
  EXPECT_NEAR(sensors[5].reading_uncertainty, std::sqrt(2) * 1e-6, 1e-15);
  EXPECT_EQ(thermal_sensors(two_planes(), {}, 0).size(), 4U) << "no distance, no tilt";
  ThermalReadings with_angle = two_planes();
  with_angle.angles = {{"B", {0, 1}, {0, 0}}};
  EXPECT_EQ(thermal_sensors(with_angle, {}, 100).size(), 6U) << "X1, Y1, X2, Y2, the B that was read, A";
  EXPECT_TRUE(has_two_planes(with_angle));
}

TEST(Etve, WhatTheReadingsDoNotSupportIsWithheld) {
  ThermalReadings readings;
  readings.displacements = {{"Z", {0, 60}, {0, 0.001}}};
  const EtveEvaluation two = evaluate_etve(readings, {}, 0);
  EXPECT_EQ(two.sensors[0].etve.value, 0.001);
  EXPECT_EQ(two.sensors[0].etve.uncertainty, 0);
  EXPECT_EQ(two.sensors[0].hourly.status, ThermalStatus::too_short);
  readings.displacements = {{"Z", {0, 600, 4000}, {0, 0.001, 0}}};
  EXPECT_EQ(evaluate_etve(readings, {}, 0).sensors[0].hourly.status, ThermalStatus::gap);
  readings.displacements = {{"Z", {0, 1800, 3600}, {0.003, 0.003, 0.003}}};
  const EtveEvaluation still = evaluate_etve(readings, {}, 0);
  EXPECT_EQ(still.sensors[0].hourly.value, 0);
  EXPECT_EQ(still.sensors[0].etve.value, 0);
}

/// 4 h of rotation from 600 s on, then 2 h of cooling; the readings begin before.
ThermalReadings spindle_readings() {
  ThermalReadings readings;
  TimeSeries z{"Z", {}, {}};
  for (int i = 0; i <= 74; ++i) {
    const double t = 300.0 * i, since = t - 600;
    const double at_stop = 0.03 * (1 - std::exp(-4 * 3600 / 2400.0));
    z.time.push_back(t);
    z.values.push_back(0.5 + (since < 0       ? 0
                              : since < 14400 ? 0.03 * (1 - std::exp(-since / 2400))
                                              : at_stop * std::exp(-(since - 14400) / 3000)));
  }
  readings.displacements = {z};
  return readings;
}

TEST(SpindleDistortionTest, WarmingAndCoolingAreToldApart) {
  const ThermalReadings readings = spindle_readings();
  const WarmingRun run{600, 15000, readings.displacements[0].to()};
  EXPECT_EQ(unread_sensor(readings, run), "");
  const SpindleDistortion found = evaluate_spindle_distortion(readings, run, {}, 0);
  ASSERT_EQ(found.sensors.size(), 1U);
  const WarmingSensor& z = found.sensors[0];
  EXPECT_NEAR(z.value_at_start, 0.5, 1e-12);
  EXPECT_NEAR(z.first_hour.value, 0.03 * (1 - std::exp(-1.5)), 1e-12);
  EXPECT_NEAR(z.running.value, 0.03 * (1 - std::exp(-6)), 1e-12);
  EXPECT_NEAR(z.change_at_stop, z.running.value, 1e-12);
  EXPECT_NEAR(z.change_at_end, z.running.value * std::exp(-(22200 - 15000) / 3000.0), 1e-12);
  EXPECT_NEAR(z.cooling.value, z.change_at_stop - z.change_at_end, 1e-12);
  ASSERT_EQ(z.warming.status, ResponseStatus::done);
  EXPECT_NEAR(z.warming.time_constant, 2400, 0.1);
  ASSERT_EQ(z.recovery.status, ResponseStatus::done);
  EXPECT_NEAR(z.recovery.time_constant, 3000, 0.1);
}

TEST(SpindleDistortionTest, AShortRunHasNoFirstHourAndUnreadTimesAreFound) {
  const ThermalReadings readings = spindle_readings();
  const SpindleDistortion found = evaluate_spindle_distortion(readings, {600, 3000, 22200}, {}, 0);
  EXPECT_EQ(found.sensors[0].first_hour.status, ThermalStatus::too_short);
  EXPECT_EQ(unread_sensor(readings, {-1, 3000, 22200}), "Z");
  EXPECT_EQ(unread_sensor(readings, {0, 30000, 30000}), "Z");
  const SpindleDistortion always = evaluate_spindle_distortion(readings, {0, 22200, 22200}, {}, 0);
  EXPECT_EQ(always.sensors[0].cooling.status, ThermalStatus::not_run);
  EXPECT_EQ(always.sensors[0].recovery.status, ResponseStatus::not_run);
}

AxisTargetReadings target_readings(double target, double offset, double per_second, double time) {
  AxisTargetReadings readings{target, "", {"deviation", {}, {}}, {}, {}};
  for (int i = 0; i < 13; ++i) {
    const double t = 300 * i + time;
    readings.deviation.time.push_back(t);
    readings.deviation.values.push_back(offset + per_second * t);
  }
  return readings;
}

TEST(AxisDistortionTest, TheDistanceIsThatAtOneTimeAlthoughTargetsAreReadInTurn) {
  // Drift common to all targets, and an expansion of 4e-9 mm/mm per second.
  AxisDistortionReadings readings;
  for (const double x : {0.0, 250.0, 500.0}) {
    readings.targets.push_back(target_readings(x, 0.01, 1e-6 + 4e-9 * x, x / 10));
  }
  const AxisDistortion found = evaluate_axis_distortion(readings, {1e-4, 0, 0});
  ASSERT_EQ(found.targets.size(), 3U);
  EXPECT_EQ(found.targets[2].number, 3U);
  EXPECT_NEAR(found.targets[0].sensors[0].change.value, 3600 * 1e-6, 1e-12);
  EXPECT_NEAR(found.targets[2].sensors[0].change_at_end, 3600 * 3e-6, 1e-12);
  ASSERT_EQ(found.expansions.size(), 1U);
  const AxisExpansion& one = found.expansions[0];
  EXPECT_EQ(one.length, 500);
  const double duration = 3600 - 50;  // from the first reading of the last target to the last one of the first target
  EXPECT_NEAR(one.distance.duration(), duration, 1e-9);
  EXPECT_NEAR(one.range.value, 4e-9 * 500 * duration, 1e-12);
  EXPECT_NEAR(one.expansion, 4e-9 * duration, 1e-15);
  EXPECT_NEAR(one.range.uncertainty, 2e-4, 1e-12);
  EXPECT_NEAR(one.expansion_uncertainty, std::sqrt(2) * 1e-4 / std::sqrt(2 * 250.0 * 250.0), 1e-15);
  EXPECT_EQ(one.response.status, ResponseStatus::not_identified) << "a straight line";
}

TEST(AxisDistortionTest, ApproachesAreEvaluatedEachForItself) {
  AxisDistortionReadings readings;
  for (const double x : {0.0, 100.0}) {
    for (const char* const approach : {"+", "-"}) {
      readings.targets.push_back(target_readings(x, approach[0] == '+' ? 0.002 : -0.002, 1e-9 * x, x));
      readings.targets.back().approach = approach;
    }
  }
  const AxisDistortion found = evaluate_axis_distortion(readings, {});
  ASSERT_EQ(found.targets.size(), 4U);
  EXPECT_EQ(found.targets[1].number, 1U);
  EXPECT_EQ(found.targets[2].number, 2U);
  ASSERT_EQ(found.expansions.size(), 2U);
  EXPECT_EQ(found.expansions[1].approach, "-");
  EXPECT_NEAR(found.expansions[0].expansion, found.expansions[1].expansion, 1e-15);
}

TEST(AxisDistortionTest, TargetsReadOneAfterTheOtherHaveNoDistance) {
  AxisDistortionReadings readings;
  readings.targets = {target_readings(0, 0, 0, 0), target_readings(100, 0, 0, 3600)};
  const AxisDistortion found = evaluate_axis_distortion(readings, {});
  EXPECT_TRUE(found.expansions.empty());
  EXPECT_EQ(found.targets[0].sensors[0].change.value, 0);
}

}  // namespace
}  // namespace abbe
