#include "abbe/study/evaluations/contour_tests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/study/evaluations/evaluation.h"
#include "abbe/study/example_file_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

SectionsTest example_sections() {
  SectionsTest test;
  test.readings = read_sections(test::example_file("laser_engraver/sections.csv"));
  return test;
}

ContourPointsTest example_points() {
  ContourPointsTest test;
  test.readings = read_point_cloud(test::example_file("laser_engraver/engraved.csv"));
  test.pieces = read_commanded_pieces(test::example_file("laser_engraver/table-a4.csv"));
  return test;
}

Evaluation contour_of(TestToEvaluate test, std::vector<std::string> tolerances = {}) {
  return evaluate_readings({"folder/x.csv", std::move(test), std::move(tolerances)});
}

TEST(EvaluationOfAContour, BySectionsHasEverySection) {
  const Evaluation evaluation = contour_of(example_sections());
  EXPECT_TRUE(evaluation.is_ok()) << evaluation.refused;
  EXPECT_EQ(evaluation.report.title, "Contour error of x.csv");
  EXPECT_EQ(evaluation.report.figures[0].symbol, "contour_mean");
  EXPECT_FALSE(evaluation.report.page["contour"].contains("limits_um"));
}

TEST(EvaluationOfAContour, ASectionWithoutAnAnswerRefusesTheMean) {
  SectionsTest test = example_sections();
  test.readings[0].points = Eigen::Matrix2Xd::Zero(2, 2);
  const Evaluation evaluation = contour_of(test, {"contour_max_um=10000"});
  EXPECT_EQ(evaluation.refused, "1 of " + std::to_string(test.readings.size()) + " sections could not be evaluated");
  EXPECT_FALSE(evaluation.report.exceeds_tolerance());
  EXPECT_FALSE(evaluation.is_ok());
}

TEST(EvaluationOfAContour, AToleranceIsInThePageOfBothKinds) {
  for (const TestToEvaluate& test : {TestToEvaluate{example_sections()}, TestToEvaluate{example_points()}}) {
    const Evaluation evaluation = contour_of(test, {"contour_max_um=12"});
    EXPECT_EQ(evaluation.report.page["contour"]["limits_um"], nlohmann::json({-12.0, 12.0})) << test.index();
    EXPECT_FALSE(contour_of(test, {"contour_mean_um=12"}).report.page["contour"].contains("limits_um"));
  }
}

TEST(EvaluationOfAContour, TheBeamsTiltIsThatOfSectionsWithoutTheirOwn) {
  SectionsTest test = example_sections();
  for (SectionReadings& section : test.readings) section.beam_tilt.reset();
  const auto mean_error = [](const SectionsTest& asked) { return *contour_of(asked).report.figures[0].value; };
  const double upright = mean_error(test);
  test.beam_tilt = 5 * kDegree;
  const double tilted = mean_error(test);
  EXPECT_GT(std::abs(tilted - upright), 1e-5);
  // What the options hold does not count.
  test.options.edge.beam_tilt = 9 * kDegree;
  EXPECT_EQ(mean_error(test), tilted);
  for (SectionReadings& section : test.readings) section.beam_tilt = 5 * kDegree;
  EXPECT_EQ(message_of([&] { contour_of(test); }),
            "--beam-tilt-deg: has no effect: the file states the beam's tilt of every section; expected a file without "
            "the column beam_tilt");
  test.beam_tilt.reset();
  EXPECT_EQ(mean_error(test), tilted);
}

TEST(EvaluationOfAContour, ByPointsSaysWhatTheirFileIs) {
  const Evaluation evaluation = contour_of(example_points());
  EXPECT_TRUE(evaluation.is_ok());
  EXPECT_THAT(evaluation.report.facts.front().second, HasSubstr("CSV, "));
  ContourPointsTest bare = example_points();
  bare.pieces.clear();
  EXPECT_EQ(message_of([&] { contour_of(bare); }), "--curve: there is no curve; expected one piece of it at least");
}

TEST(EvaluationOfAContour, ACurveOfAxesNeedsTheirMachine) {
  const std::string curve = test::example_file("laser_engraver/regions.ngc");
  EXPECT_THAT(message_of([&] { read_commanded_pieces(curve); }),
              HasSubstr("regions.ngc:3: C2=0: the command of an axis, and no machine is given; expected --machine"));
  const std::string machine = ABBE_SOURCE_DIR "/examples/machines/yin-engraver-u.machine.toml";
  const std::vector<CommandPiece> pieces = read_commanded_pieces(curve, machine);
  EXPECT_GT(pieces.size(), 1U);
  EXPECT_THAT(message_of([&] { read_commanded_pieces(curve, machine, true); }), testing::StartsWith("--closed: "));
  EXPECT_THAT(message_of([&] { read_commanded_pieces(test::example_file("laser_engraver/engraved.csv")); }),
              testing::Not(HasSubstr("--machine")));
}

}  // namespace
}  // namespace abbe
