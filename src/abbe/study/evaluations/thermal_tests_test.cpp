#include "abbe/study/evaluations/thermal_tests.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "abbe/formats/text/message_of.h"
#include "abbe/study/evaluations/evaluation.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

EvaluationRequest thermal_request(TestToEvaluate test) { return {"folder/t.csv", std::move(test), {}}; }

std::string problem_of_thermal_test(TestToEvaluate test) {
  return message_of([&] { evaluate_readings(thermal_request(std::move(test))); });
}

const EvaluationFigure* thermal_figure_of(const Evaluation& evaluation, const std::string& symbol) {
  for (const EvaluationFigure& figure : evaluation.report.figures) {
    if (figure.symbol == symbol) return &figure;
  }
  return nullptr;
}

/// The value in the unit in which it is shown; not a number if there is no such figure or value.
double shown_value(const Evaluation& evaluation, const std::string& symbol) {
  const EvaluationFigure* const figure = thermal_figure_of(evaluation, symbol);
  return figure && figure->value ? figure_number(*figure, *figure->value) : std::nan("");
}

EtveTest etve_by_hand() {
  EtveTest test;
  test.readings = parse_thermal(
      "time_min,X_um,A_urad,air_degC\n0,1,0,20\n30,2,1,21\n60,4,0,22\n90,3,-2,22.5\n120,-1,0,23\n", "t.csv");
  return test;
}

TEST(EvaluationOfEtve, FiguresByHand) {
  EvaluationRequest request = thermal_request(etve_by_hand());
  std::get<EtveTest>(request.test).displacement_uncertainty = 1e-4;
  std::get<EtveTest>(request.test).temperature_uncertainty = 0.1;
  request.tolerances = {"ETVE_X_um=5.1", "rate_air_K_per_h=1.9"};
  const Evaluation found = evaluate_readings(request);
  EXPECT_EQ(shown_value(found, "ETVE_X"), 5);
  EXPECT_EQ(shown_value(found, "ETVE1h_X"), 5);
  EXPECT_EQ(shown_value(found, "ETVE_A"), 3);
  EXPECT_EQ(shown_value(found, "ETVE1h_A"), 3);
  EXPECT_EQ(shown_value(found, "T_air"), 3);
  EXPECT_NEAR(shown_value(found, "rate_air"), 2, 1e-9);
  const EvaluationFigure& etve = *thermal_figure_of(found, "ETVE_X");
  EXPECT_NEAR(*etve.uncertainty, 2 * std::sqrt(2) * 1e-4, 1e-12);
  EXPECT_EQ(etve.verdict(), "within, not proven");
  EXPECT_FALSE(thermal_figure_of(found, "ETVE_A")->uncertainty) << "of another unit";
  EXPECT_EQ(thermal_figure_of(found, "rate_air")->verdict(), "exceeded, not proven");
  EXPECT_FALSE(found.is_ok());
  EXPECT_EQ(found.report.kind, "etve");
  EXPECT_EQ(found.report.title, "Environmental temperature variation error of t.csv");
  EXPECT_EQ(found.report.details["temperatures"][0]["mean_degC"],
            std::get<EtveEvaluation>(found.found).temperatures[0].mean);
  EXPECT_EQ(found.report.plots.size(), 3U);
}

TEST(EvaluationOfEtve, TheLengthHasItsExpansionAndItsUncertainty) {
  EtveTest test = etve_by_hand();
  test.length = 1000;
  test.workpiece_expansion = 23e-6;
  test.workpiece_expansion_uncertainty = 1e-6;
  test.workpiece_temperature = 24;
  test.workpiece_temperature_uncertainty = 0.1;
  test.scale_expansion = 8e-6;
  const Evaluation found = evaluate_readings(thermal_request(test));
  const double mean = std::get<EtveEvaluation>(found.found).mean_temperature();
  EXPECT_NEAR(mean, (20.5 + 21.5 + 22.25 + 22.75) / 4, 1e-12);
  EXPECT_NEAR(shown_value(found, "NDE"), 1000 * (23e-3 * 4 - 8e-3 * (mean - 20)), 1e-6);
  const double expansion = 1e-3 * std::hypot(4, 0.1), temperature = 2.3e-3, environment = 5e-3 / std::sqrt(12);
  EXPECT_NEAR(shown_value(found, "U_L"), 2e3 * std::hypot(expansion, temperature, environment), 1e-6);
  EXPECT_NEAR(*thermal_figure_of(found, "NDE")->uncertainty, 2 * std::hypot(expansion, temperature), 1e-12);
  EXPECT_EQ(found.report.details["uncertainty_contributions"].size(), 3U);
}

TEST(EvaluationOfEtve, NumbersThatHaveNoEffectAreRefused) {
  EtveTest test = etve_by_hand();
  test.scale_temperature = 21;
  EXPECT_EQ(problem_of_thermal_test(test),
            "--scale-temperature-degC: has no effect without a length; expected also --length-mm");
  test.length = 100;
  EXPECT_THAT(problem_of_thermal_test(test),
              StartsWith("--scale-temperature-degC: has no effect without the coefficient"));
  test.scale_temperature = kNotStated;
  EXPECT_THAT(problem_of_thermal_test(test),
              StartsWith("--length-mm: has no effect without a coefficient of expansion"));
  test.workpiece_expansion = 12e-6;
  test.readings.temperatures.clear();
  EXPECT_THAT(problem_of_thermal_test(test), StartsWith("--workpiece-temperature-degC: is not stated"));
  test.readings.displacements.clear();
  test.readings.angles.clear();
  EXPECT_EQ(problem_of_thermal_test(test), "folder/t.csv: there are no readings; expected one at least");
  EXPECT_EQ(problem_of_thermal_test(EtveTest()), "folder/t.csv: there are no readings; expected one at least");
}

TEST(EvaluationOfEtve, TwoReadingsAndNoChangeAreEnough) {
  EtveTest test;
  test.readings = parse_thermal("time_s,X_um\n0,5\n10,5\n", "t.csv");
  const Evaluation found = evaluate_readings(thermal_request(test));
  EXPECT_EQ(shown_value(found, "ETVE_X"), 0);
  EXPECT_EQ(thermal_figure_of(found, "ETVE1h_X")->missing, "the readings last less than an hour");
  EXPECT_THAT(found.report.notes.back(), HasSubstr("There is no temperature"));
  EXPECT_TRUE(found.is_ok());
}

TEST(EvaluationOfEtve, ExtremeTimesAndValuesStayFinite) {
  EtveTest test;
  test.readings = parse_thermal("time_s,X_um,A_rad\n-1e9,1e9,3\n0,-1e9,-3\n1e9,1e9,1e-9\n", "t.csv");
  const Evaluation found = evaluate_readings(thermal_request(test));
  EXPECT_EQ(shown_value(found, "ETVE_X"), 2e9);
  EXPECT_EQ(thermal_figure_of(found, "ETVE1h_X")->missing, "there is no reading for more than half an hour");
}

SpindleDistortionTest spindle_test() {
  std::string text = "time_min,Z_um,X1_um,X2_um\n";
  for (int i = 0; i <= 60; ++i) {
    const double warm = i <= 40 ? 1 - std::exp(-i / 8.0) : (1 - std::exp(-5.0)) * std::exp(-(i - 40) / 10.0);
    text += fmt::format("{},{:.6f},{:.6f},{:.6f}\n", 5 * i, 30 * warm, 4 * warm, 10 * warm);
  }
  SpindleDistortionTest test;
  test.readings = parse_thermal(text, "s.csv");
  return test;
}

TEST(EvaluationOfASpindle, FiguresOfWarmingAndCooling) {
  SpindleDistortionTest test = spindle_test();
  test.stop = 200 * 60;
  test.plane_distance = 100;
  const Evaluation found = evaluate_readings(thermal_request(test));
  EXPECT_NEAR(shown_value(found, "d60_Z"), 30 * (1 - std::exp(-1.5)), 1e-5);
  EXPECT_NEAR(shown_value(found, "d_Z"), 30 * (1 - std::exp(-5.0)), 1e-5);
  EXPECT_NEAR(shown_value(found, "dcool_Z"), 30 * (1 - std::exp(-5.0)) * (1 - std::exp(-2.0)), 1e-5);
  EXPECT_NEAR(shown_value(found, "tau_Z"), 40, 0.01);
  EXPECT_NEAR(shown_value(found, "d_B"), 60 * (1 - std::exp(-5.0)), 1e-4) << "6 um over 100 mm";
  EXPECT_NEAR(found.report.details["sensors"][0]["cooling"]["time_constant_min"].get<double>(), 50, 0.01);
  EXPECT_EQ(found.report.facts[1], (std::pair<std::string, std::string>("cooling", "1 h 40 min")));
}

TEST(EvaluationOfASpindle, WithoutAStopTheShapeIsRefusedForATimeConstant) {
  const Evaluation found = evaluate_readings(thermal_request(spindle_test()));
  EXPECT_EQ(thermal_figure_of(found, "dcool_Z"), nullptr);
  EXPECT_EQ(thermal_figure_of(found, "tau_Z")->missing, "the readings do not follow a first-order response");
  EXPECT_TRUE(found.is_ok()) << "the figures that were asked for are there";
}

TEST(EvaluationOfASpindle, TimesThatTheReadingsDoNotHaveAreRefused) {
  SpindleDistortionTest test = spindle_test();
  test.stop = 0;
  EXPECT_EQ(problem_of_thermal_test(test),
            "folder/t.csv: --stop-min: the spindle stops at 0 min and starts at 0 min; expected a stop after the "
            "start, on the time scale of the file");
  test.stop = 301 * 60;
  EXPECT_THAT(problem_of_thermal_test(test), StartsWith("folder/t.csv: Z: was not read from 0 to 301 min"));
  test.stop = kNotStated;
  test.start = 400 * 60;
  EXPECT_THAT(problem_of_thermal_test(test), StartsWith("folder/t.csv: --start-min: the spindle stops at 300 min"));
}

TEST(EvaluationOfAMovingAxis, FiguresByHand) {
  AxisDistortionTest test;
  test.readings = parse_axis_distortion(
      "time_min,target_mm,deviation_um,B_urad\n0,100,0,0\n0,600,1,0\n60,100,2,1\n60,600,8,4\n120,100,1,2\n120,600,7,"
      "5\n",
      "a.csv");
  test.displacement_uncertainty = 2e-4;
  const Evaluation found = evaluate_readings(thermal_request(test));
  EXPECT_EQ(shown_value(found, "d_P1"), 2);
  EXPECT_EQ(shown_value(found, "d_P2"), 7);
  EXPECT_EQ(shown_value(found, "d_P2_B"), 5);
  EXPECT_EQ(shown_value(found, "d_L"), 5);
  EXPECT_NEAR(shown_value(found, "expansion_L"), 5 / 0.5, 1e-9);
  EXPECT_NEAR(*thermal_figure_of(found, "expansion_L")->uncertainty, 4 * 2e-4 / 500, 1e-12);
  EXPECT_EQ(thermal_figure_of(found, "tau_L")->missing, "too few readings that are independent of each other");
  EXPECT_EQ(problem_of_thermal_test(AxisDistortionTest()),
            "folder/t.csv: there are no readings; expected one at least");
}

TEST(ThermalNumbers, DefaultsAreThoseOfTheTests) {
  for (const auto& number : etve_numbers()) {
    const double value = EtveTest().*number.value;
    EXPECT_TRUE(std::isnan(value) || value == 0) << number.option;
    EXPECT_LT(number.from, number.to) << number.option;
  }
}

}  // namespace
}  // namespace abbe
