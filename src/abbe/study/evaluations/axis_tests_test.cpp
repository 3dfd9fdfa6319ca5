#include "abbe/study/evaluations/axis_tests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/study/evaluations/evaluation.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

EvaluationRequest axis_request(TestToEvaluate test) { return {"folder/x.csv", std::move(test), {}}; }

std::string problem_of_axis_test(TestToEvaluate test) {
  return message_of([&] { evaluate_readings(axis_request(std::move(test))); });
}

/// The figure of that symbol; a figure without name if there is none.
EvaluationFigure figure_of(const Evaluation& evaluation, const std::string& symbol) {
  for (const EvaluationFigure& figure : evaluation.report.figures) {
    if (figure.symbol == symbol) return figure;
  }
  ADD_FAILURE() << "no figure " << symbol;
  return {};
}

/// Two targets and two runs, worked by hand in positioning_test.cpp.
PositioningTest positioning_by_hand() {
  PositioningTest test;
  test.readings = parse_positioning(
      "run,direction,target_mm,deviation_um\n1,+,0,1\n1,+,100,4\n1,-,100,5\n1,-,0,-1\n2,+,0,3\n2,+,100,4\n2,-,100,7\n"
      "2,-,0,-1\n",
      "x.csv");
  return test;
}

PositioningTest rotary_positioning() {
  PositioningTest test;
  test.readings = parse_positioning("direction,target_deg,deviation_arcsec\n+,0,0\n+,90,2\n-,90,3\n-,0,1\n", "x.csv");
  return test;
}

/// A circle of radius 100 mm, read every two degrees over that angle, in mm.
CircularTest circle_of_ball_bar(int degrees) {
  CircularTest test;
  test.nominal_radius = 100;
  CircularReadings& path = test.readings.paths[static_cast<std::size_t>(CircularDirection::clockwise)];
  for (int at = 0; at < degrees; at += 2) {
    path.angle.push_back(at * kDegree);
    path.radius.push_back(100.001 + 0.002 * std::cos(2 * at * kDegree));
  }
  return test;
}

TEST(EvaluationOfAnAxis, FiguresAreJudgedAndTheRequestIsNeededNoLonger) {
  EvaluationRequest request = axis_request(positioning_by_hand());
  request.tolerances = {"E_um=7"};
  const Evaluation within = evaluate_readings(request);
  EXPECT_TRUE(within.is_ok());
  EXPECT_EQ(within.report.title, "Positioning: x.csv");
  EXPECT_NEAR(*figure_of(within, "E").value, 7e-3, 1e-12);
  EXPECT_NEAR(figure_of(within, "E").tolerance.value_or(0), 7e-3, 1e-12);
  EXPECT_FALSE(figure_of(within, "A").tolerance);
  request.tolerances = {"E_um=6.9", "A_um=100"};
  const Evaluation beyond = evaluate_readings(request);
  EXPECT_FALSE(beyond.is_ok());
  EXPECT_EQ(beyond.refused, "") << "the figures are there";
  request.tolerances = {"Q_um=1"};
  EXPECT_THAT(message_of([&] { evaluate_readings(request); }),
              StartsWith("--tolerance Q_um=1: there is no such figure"));
}

TEST(EvaluationOfAnAxis, HasTheNumbersBehindItsFigures) {
  const Evaluation axis = evaluate_readings(axis_request(positioning_by_hand()));
  EXPECT_EQ(std::get<PositioningEvaluation>(axis.found).systematic.figure.value, *figure_of(axis, "E").value);
  const Evaluation circle = evaluate_readings(axis_request(circle_of_ball_bar(360)));
  const auto& found = std::get<CircularEvaluation>(circle.found);
  EXPECT_EQ(found.deviations.paths[0].circular, *figure_of(circle, "G_cw").value);
  EXPECT_EQ(found.diagnosis.residuals[0].size(), 180U);
  StraightnessTest line;
  line.readings = {"", {0, 1, 2, 3}, {0, 1e-3, 1e-3, 0}};
  EXPECT_NEAR(std::get<StraightnessEvaluation>(evaluate_readings(axis_request(line)).found).minimum_zone.value, 1e-3,
              1e-12);
}

TEST(EvaluationOfAnAxis, ContributionsToTheUncertaintyHaveTheirOptions) {
  PositioningTest test;
  for (const PositioningContribution& contribution : positioning_contributions()) {
    EXPECT_THAT(contribution.option, StartsWith("--"));
    EXPECT_EQ((test.*contribution.axis).*contribution.value, 0) << contribution.option << " is there twice";
    (test.*contribution.axis).*contribution.value = contribution.unit;
  }
  EXPECT_EQ(test.rotary.setup, kArcsec);
  EXPECT_EQ(test.linear.instrument_per_length, 1e-6);
}

TEST(EvaluationOfAnAxis, WithoutReadingsThereIsNone) {
  const std::string expected = "folder/x.csv: there are no readings; expected one at least";
  CircularTest circular;
  circular.nominal_radius = 1;
  for (const TestToEvaluate& test :
       {TestToEvaluate{}, TestToEvaluate{DiagonalsTest{}}, TestToEvaluate{DiagonalsTest{{DiagonalReadings{}}}},
        TestToEvaluate{circular}, TestToEvaluate{RotationTest{}}, TestToEvaluate{StraightnessTest{}},
        TestToEvaluate{SquarenessTest{}}, TestToEvaluate{SectionsTest{}}}) {
    EXPECT_EQ(problem_of_axis_test(test), expected) << test.index();
  }
}

TEST(EvaluationOfAnAxis, UncertaintyIsThatOfItsKind) {
  PositioningTest linear = positioning_by_hand();
  EXPECT_FALSE(figure_of(evaluate_readings(axis_request(linear)), "E").uncertainty);
  linear.linear.instrument = 0.5e-3;
  EXPECT_NEAR(figure_of(evaluate_readings(axis_request(linear)), "E").uncertainty.value_or(0), 0.5e-3, 1e-12);
  linear.rotary.setup = kArcsec;
  EXPECT_THAT(problem_of_axis_test(linear), StartsWith("an uncertainty in arcsec was given for a linear axis"));
  PositioningTest rotary = rotary_positioning();
  rotary.rotary.instrument = kArcsec;
  EXPECT_NEAR(figure_of(evaluate_readings(axis_request(rotary)), "E").uncertainty.value_or(0), kArcsec, 1e-15);
  const std::string by_length = "an uncertainty in um or by length or temperature was given for a rotary axis";
  rotary.linear.environmental_variation = 1e-3;
  EXPECT_THAT(problem_of_axis_test(rotary), StartsWith(by_length));
  // A coefficient without a range states nothing.
  rotary.linear = {};
  rotary.linear.machine_expansion = 11e-6;
  EXPECT_TRUE(evaluate_readings(axis_request(rotary)).is_ok());
  rotary.linear = {};
  rotary.rotary.misalignment_range = 1;
  EXPECT_THAT(problem_of_axis_test(rotary), StartsWith(by_length));
}

TEST(EvaluationOfAnAxis, DiagonalsAreThoseOfTheFile) {
  DiagonalsTest test;
  test.readings = read_diagonals(ABBE_SOURCE_DIR "/examples/evaluate/diagonals.csv");
  const Evaluation evaluation = evaluate_readings(axis_request(test));
  EXPECT_TRUE(evaluation.is_ok());
  EXPECT_EQ(evaluation.report.kind, "diagonals");
  EXPECT_NEAR(*figure_of(evaluation, "B_d").value, 1.2e-3, 0.6e-3);
}

TEST(EvaluationOfACircle, HasItsPlaneAndItsFigures) {
  CircularTest test = circle_of_ball_bar(360);
  const Evaluation evaluation = evaluate_readings(axis_request(test));
  EXPECT_TRUE(evaluation.is_ok()) << evaluation.refused;
  EXPECT_NEAR(*figure_of(evaluation, "G_cw").value, 4e-3, 1e-6);
  EXPECT_EQ(evaluation.report.facts[0].second, "XY");
  test.plane = "ZX";
  EXPECT_EQ(evaluate_readings(axis_request(test)).report.facts[0].second, "ZX");
  test.readings.plane = "ZX";
  EXPECT_TRUE(evaluate_readings(axis_request(test)).is_ok());
  test.plane = "YZ";
  EXPECT_EQ(problem_of_axis_test(test),
            "folder/x.csv: --plane YZ: the coordinates of the file are those of ZX; expected --plane only for files of "
            "a ball bar");
  test.plane = "X";
  EXPECT_EQ(problem_of_axis_test(test), "--plane X: there is no such plane; expected XY, YZ or ZX");
  test = circle_of_ball_bar(360);
  test.nominal_radius = 0;
  EXPECT_EQ(problem_of_axis_test(test), "--radius-mm: 0 is not valid; expected a length in mm above zero");
}

TEST(EvaluationOfACircle, OfAShortArcIsRefused) {
  CircularTest test = circle_of_ball_bar(100);
  const Evaluation refused = evaluate_readings(axis_request(test));
  EXPECT_THAT(refused.refused, StartsWith("circular deviation, clockwise: the arc is shorter than 200"));
  EXPECT_FALSE(refused.is_ok());
  EXPECT_FALSE(refused.report.exceeds_tolerance());
  test.centre = CircularCentre::instrument;
  EXPECT_TRUE(evaluate_readings(axis_request(test)).is_ok());
}

TEST(EvaluationOfARotation, NeedsTurns) {
  RotationTest test;
  const auto turns = [&](int count) {
    test.readings = {};
    for (int i = 0; i < 36 * count; ++i) {
      test.readings.angle.push_back(10 * i * kDegree);
      test.readings.axial.push_back(0.5e-3 * std::cos(10 * i * kDegree));
    }
    return evaluate_readings(axis_request(test));
  };
  const Evaluation few = turns(3);
  EXPECT_EQ(few.refused, "fewer than 4 whole turns");
  EXPECT_FALSE(few.is_ok());
  const Evaluation enough = turns(6);
  EXPECT_TRUE(enough.is_ok()) << enough.refused;
  EXPECT_NEAR(*figure_of(enough, "axial_fundamental").value, 1e-3, 1e-6);
}

TEST(EvaluationOfALine, ByBothReferencesAndWithAStatedUncertainty) {
  StraightnessTest test;
  test.readings = {"", {0, 1, 2, 3}, {0, 1e-3, 1e-3, 0}};
  const Evaluation plain = evaluate_readings(axis_request(test));
  EXPECT_NEAR(*figure_of(plain, "straightness_mz").value, 1e-3, 1e-12);
  EXPECT_FALSE(figure_of(plain, "straightness_mz").uncertainty);
  test.reading_uncertainty = 0.1e-3;
  EXPECT_TRUE(figure_of(evaluate_readings(axis_request(test)), "straightness_mz").uncertainty);
}

TEST(EvaluationOfALine, SquarenessHasTheAngleOfTheSquare) {
  SquarenessTest test;
  test.readings = {LineReadings{"X", {0, 100, 200}, {0, 1e-3, 2e-3}}, LineReadings{"Y", {0, 100, 200}, {0, 0, 0}}};
  EXPECT_NEAR(*figure_of(evaluate_readings(axis_request(test)), "squareness").value, -1e-5, 1e-12);
  test.options.artefact = 3e-5;
  EXPECT_NEAR(*figure_of(evaluate_readings(axis_request(test)), "squareness").value, 2e-5, 1e-12);
  test.readings[1] = {};
  EXPECT_THAT(problem_of_axis_test(test), HasSubstr("there are no readings"));
}

}  // namespace
}  // namespace abbe
