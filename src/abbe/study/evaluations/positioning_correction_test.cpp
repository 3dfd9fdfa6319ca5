#include "abbe/study/evaluations/positioning_correction.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/report/customer/customer_notes.h"
#include "abbe/study/evaluations/evaluation.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// A scale of 10 um/(m K) at 24 degC and later, which moves the axis too far, read by a laser in compensated air.
/// @param columns  of the temperatures; "machine_degC", "time_min" or nothing
std::string warm_file(const std::string& column, double per_run = 0) {
  std::string text = "run,direction,target_mm,deviation_um" + (column.empty() ? "" : "," + column) + "\n";
  for (int run = 0; run < 5; ++run) {
    for (const char* const side : {"+", "-"}) {
      for (int i = 0; i <= 5; ++i) {
        const double target = 200.0 * i, degrees = 24 + per_run * run;
        const double at_20 = (*side == '+' ? 1 : -1) + 0.002 * target + (run % 2 == 0 ? 0.1 : -0.1);
        text += fmt::format("{},{},{},{:.9f}", run + 1, side, target, at_20 + 1e-3 * 10 * (degrees - 20) * target);
        if (column == "machine_degC") text += fmt::format(",{}", degrees);
        if (column == "time_min") text += fmt::format(",{}", 10 * run);
        text += "\n";
      }
    }
  }
  return text;
}

PositioningTest warm_positioning(const std::string& column = "", double per_run = 0) {
  PositioningTest test;
  test.readings = parse_positioning(warm_file(column, per_run), "x.csv");
  test.linear.machine_expansion = 10e-6;
  return test;
}

Evaluation evaluated_test(TestToEvaluate test) { return evaluate_readings({"folder/x.csv", std::move(test), {}}); }

double value_of_figure(const Evaluation& evaluation, const std::string& symbol, bool uncertainty = false) {
  for (const EvaluationFigure& figure : evaluation.report.figures) {
    if (figure.symbol != symbol) continue;
    return 1e3 * (uncertainty ? figure.uncertainty.value_or(-1e-3) : figure.value.value_or(NAN));
  }
  ADD_FAILURE() << symbol;
  return 0;
}

TEST(PositioningAt20Degrees, OneTemperatureOfTheWholeTest) {
  PositioningTest test = warm_positioning();
  test.expansion.machine_temperature = 24;
  test.expansion.machine_coefficient_uncertainty = 1;
  test.expansion.machine_temperature_uncertainty = 0.3;
  const Evaluation result = evaluated_test(test);
  // At 20 degC: 2 um over 1 m, 2 um of reversal; warm: 40 um more.
  EXPECT_NEAR(value_of_figure(result, "E"), 4, 1e-6);
  EXPECT_NEAR(value_of_figure(result, "M"), 2, 1e-6);
  EXPECT_NEAR(value_of_figure(result, "B"), 2, 1e-6);
  EXPECT_NEAR(result.report.details["as_read"]["E_um"].get<double>(), 44, 1e-6);
  EXPECT_NEAR(result.report.details["as_read"]["targets"][5]["mean_positive_um"].get<double>(), 43, 0.03);
  // u^2 = (1 * 4)^2 + (10^2 + 1^2) 0.3^2 um^2 over 1 m.
  EXPECT_NEAR(value_of_figure(result, "E", true), 2 * std::sqrt(16 + 101 * 0.09), 1e-6);
  EXPECT_NEAR(value_of_figure(result, "M", true), 2 * std::sqrt(16 + 101 * 0.09), 1e-6);
  EXPECT_NEAR(value_of_figure(result, "B", true), 0, 1e-9);
  EXPECT_EQ(result.report.details["expansion"]["machine"]["temperatures_degC"][0], 24);
  EXPECT_NEAR(value_of_figure(evaluated_test(warm_positioning()), "E"), 44, 1e-6) << "without a temperature";
}

TEST(PositioningAt20Degrees, ATemperatureOfEveryReadingAndOneOverTime) {
  // The axis warms by 0.5 K from run to run: as read, that is repeatability.
  const PositioningTest by_column = warm_positioning("machine_degC", 0.5);
  PositioningTest over_time = warm_positioning("time_min", 0.5);
  over_time.temperatures = parse_temperature_record("time_min,machine_degC\n0,24\n40,26\n", "t.csv");
  for (const PositioningTest& test : {by_column, over_time}) {
    const Evaluation result = evaluated_test(test);
    EXPECT_NEAR(value_of_figure(result, "E"), 4, 1e-6);
    EXPECT_NEAR(value_of_figure(result, "R+"), 4 * std::sqrt(5 * 0.0096 / 4), 1e-5);
    EXPECT_GT(result.report.details["as_read"]["R+_um"].get<double>(), 30);
    EXPECT_EQ(value_of_figure(result, "E", true), -1) << "no uncertainty is stated";
    EXPECT_THAT(result.report.notes.back(), HasSubstr("counts as exact"));
    for (const std::string& note : result.report.notes) {
      if (note.find("20 ") == std::string::npos) continue;
      EXPECT_TRUE(customer_note(note, ReportLanguage::german)) << note;
    }
  }
}

TEST(PositioningAt20Degrees, OtherContributionsAreAddedAndRangesAreThoseOfTheCorrection) {
  PositioningTest test = warm_positioning();
  test.expansion.machine_temperature = 24;
  test.linear.instrument_per_length = 2e-6;
  test.linear.machine_expansion_range = std::sqrt(12.0) * 1e-6;
  const Evaluation result = evaluated_test(test);
  EXPECT_NEAR(value_of_figure(result, "E", true), std::hypot(2, 8), 1e-6);
  ASSERT_EQ(result.report.details["uncertainty_contributions"].size(), 2U) << "the range counts once";
  EXPECT_EQ(result.report.details["uncertainty_contributions"][1]["name"], "expansion of the machine");
  EXPECT_NEAR(result.report.details["uncertainty_contributions"][1]["expanded_uncertainty_um"].get<double>(), 8, 1e-6);
}

std::string problem_at_20_degrees(const PositioningTest& test) {
  return message_of([&] { evaluated_test(test); });
}

TEST(PositioningAt20Degrees, WhatMissesEachOtherIsNamed) {
  PositioningTest test = warm_positioning();
  test.linear.machine_expansion = 0;
  test.expansion.machine_temperature = 24;
  EXPECT_THAT(problem_at_20_degrees(test),
              HasSubstr("--machine-expansion-um-per-m-K: is missing, but the machine has a temp"));
  test = warm_positioning();
  test.expansion.machine_temperature_uncertainty = 1;
  EXPECT_THAT(problem_at_20_degrees(test),
              HasSubstr("--u-machine-temperature-K: has no effect without the temperature"));
  test.expansion.machine_temperature = 24;
  test.linear.device_expansion = 11e-6;
  EXPECT_THAT(problem_at_20_degrees(test),
              HasSubstr("--instrument-temperature-degC: is missing, but readings are corrected"));
  test = warm_positioning();
  test.expansion.machine_temperature = 24;
  test.linear.temperature_from_20_C = 4;
  EXPECT_THAT(problem_at_20_degrees(test), HasSubstr("--temperature-from-20C-K: is given together with a temperature"));
  test = warm_positioning("machine_degC");
  test.expansion.machine_temperature = 24;
  EXPECT_THAT(problem_at_20_degrees(test), HasSubstr("--machine-temperature-degC: is given together with a column"));
  test = warm_positioning("time_min");
  test.temperatures = parse_temperature_record("time_min,machine_degC\n0,24\n30,26\n", "t.csv");
  EXPECT_THAT(problem_at_20_degrees(test),
              HasSubstr("time: reading 49 was taken at 40 min, and the temperatures of t.csv are "
                        "those from 0 to 30 min"));
  test = warm_positioning();
  test.temperatures = parse_temperature_record("time_min,machine_degC\n0,24\n30,26\n", "t.csv");
  EXPECT_THAT(problem_at_20_degrees(test), HasSubstr("time_min: missing column"));
  test = warm_positioning();
  test.expansion.machine_temperature = 24;
  test.linear.machine_temperature_range = 1;
  test.expansion.machine_temperature_uncertainty = 0.3;
  EXPECT_THAT(problem_at_20_degrees(test), HasSubstr("is given together with --machine-temperature-range-K"));
  test = warm_positioning();
  test.expansion.common_temperature_uncertainty = 0.1;
  EXPECT_THAT(problem_at_20_degrees(test), HasSubstr("--u-common-temperature-K: has no effect"));
  PositioningTest rotary;
  rotary.readings = parse_positioning("direction,target_deg,deviation_arcsec\n+,0,0\n+,90,2\n", "x.csv");
  rotary.expansion.machine_temperature = 24;
  EXPECT_THAT(problem_at_20_degrees(rotary), HasSubstr("--machine-expansion-um-per-m-K: is missing"));
}

TEST(CircularAt20Degrees, RadiiAreThoseOfTheMachineAndTheBarAt20Degrees) {
  CircularTest test;
  test.nominal_radius = 150;
  test.reading_uncertainty = 1e-4;
  test.length_uncertainty = 3e-4;
  // Scales of 10 um/(m K) at 25 degC drive a circle that is too large, and a bar of 12 um/(m K) at 23 degC reads less.
  for (CircularReadings& path : test.readings.paths) {
    for (int at = 0; at < 360; at += 3) {
      path.angle.push_back(at * kDegree);
      path.radius.push_back((150.002 + 0.004 * std::cos(2 * at * kDegree)) * (1 + 50e-6) / (1 + 36e-6));
    }
  }
  test.expansion.machine_coefficient = 10;
  test.expansion.machine_temperature = 25;
  test.expansion.machine_temperature_uncertainty = 0.4;
  test.expansion.instrument_coefficient = 12;
  test.expansion.instrument_temperature = 23;
  test.expansion.instrument_coefficient_uncertainty = 0.5;
  const Evaluation result = evaluated_test(test);
  EXPECT_NEAR(value_of_figure(result, "Fmax_cw"), 6, 1e-4);
  EXPECT_NEAR(value_of_figure(result, "D"), 2, 1e-4);
  EXPECT_NEAR(value_of_figure(result, "G_b"), 8, 1e-4);
  EXPECT_NEAR(result.report.details["as_read"]["D_um"].get<double>(), 2 + 150 * 14e-3, 1e-3);
  // u^2 of the radius: (10 * 0.4)^2 + (0.5 * 3)^2 um^2/m^2, 0.15 m; and 0.3 um as stated.
  const double u_length = std::hypot(0.15 * std::hypot(4, 1.5), 0.3);
  EXPECT_NEAR(value_of_figure(result, "D", true), 2 * u_length, 0.02);
  EXPECT_TRUE(
      customer_note("The radii are corrected to 20 °C for the nominal differential expansion of machine and "
                    "instrument (ISO 230-4).",
                    ReportLanguage::japanese));
  CircularTest missing = test;
  missing.expansion.machine_coefficient = kNotStated;
  EXPECT_THAT(message_of([&] { evaluated_test(missing); }), HasSubstr("--machine-expansion-um-per-m-K: is missing"));
}

}  // namespace
}  // namespace abbe
