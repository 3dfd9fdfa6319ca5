#include "abbe/study/evaluations/linkage_tests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/study/evaluations/evaluation.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const char* const kEngraver = ABBE_SOURCE_DIR "/examples/machines/yin-engraver-u.machine.toml";

LinkageTest example_linkage(bool with_machine = true) {
  LinkageTest test;
  test.readings = read_linkage(ABBE_SOURCE_DIR "/examples/laser_engraver/five-steps.csv");
  test.readings.exit_to_axis = 120;
  test.readings.board_thickness = 4;
  if (with_machine) test.machine = read_machine(kEngraver);
  test.machine_file = "u.machine.toml";
  return test;
}

Evaluation linkage_evaluation(const LinkageTest& test) { return evaluate_readings({"folder/steps.csv", test, {}}); }

std::string linkage_problem(const LinkageTest& test) {
  return message_of([&] { linkage_evaluation(test); });
}

TEST(EvaluationOfALinkage, FindsTheErrorsOfAMachineAsAFile) {
  LinkageTest test = example_linkage();
  const Evaluation exact = linkage_evaluation(test);
  EXPECT_TRUE(exact.is_ok());
  EXPECT_EQ(exact.report.title, "Linkage of steps.csv");
  ASSERT_EQ(exact.files.size(), 1U);
  EXPECT_EQ(exact.files[0].first, "errors.toml");
  EXPECT_THAT(exact.report.notes.back(), testing::StartsWith("Not stated, taken as exact: --u-x-um, --u-y-um, "));
  const ErrorsFile read = parse_errors(exact.files[0].second, "errors.toml", *test.machine);
  EXPECT_EQ(read.errors.parameters().size(), 7U);
  EXPECT_EQ(read.errors.parameters()[0], *exact.report.figures[7].value);
  test.accuracy = LinkageAccuracy::published();
  const Evaluation stated = linkage_evaluation(test);
  ASSERT_EQ(stated.files.size(), 2U);
  EXPECT_EQ(stated.files[1].first, "errors.covariance.csv");
  EXPECT_THAT(stated.files[0].second, HasSubstr("errors.covariance.csv"));
  EXPECT_EQ(stated.report.notes.back(), "Not stated, taken as exact: --u-exit-to-axis-um, --u-board-um.");
  test.accuracy.exit_to_axis = test.accuracy.thickness = 1e-3;
  for (const std::string& note : linkage_evaluation(test).report.notes)
    EXPECT_THAT(note, testing::Not(HasSubstr("--u-")));
}

TEST(EvaluationOfALinkage, TheConventionIsThatOfTheMachineOrAsStated) {
  const auto axes_of = [](const LinkageTest& test) { return linkage_evaluation(test).report.facts[0].second; };
  LinkageTest test = example_linkage(false);
  EXPECT_THAT(axes_of(test), HasSubstr("X and Y carry the table"));
  EXPECT_TRUE(linkage_evaluation(test).files.empty());
  test.convention = LinkageConvention::head_moves;
  EXPECT_THAT(axes_of(test), HasSubstr("X, Y and Z carry the head"));
  test.machine = read_machine(kEngraver);
  EXPECT_EQ(linkage_problem(test),
            "--convention head-moves: is not what the machine's chain says; expected table-moves, or without it");
  test.convention = LinkageConvention::table_moves;
  // The readings' own convention does not count.
  test.readings.convention = LinkageConvention::head_moves;
  EXPECT_THAT(axes_of(test), HasSubstr("X and Y carry the table"));
}

TEST(EvaluationOfALinkage, WhatDeterminesNoneIsNamed) {
  LinkageTest test = example_linkage();
  for (double& angle : test.readings.table_angle) angle = -angle;
  EXPECT_THAT(linkage_problem(test),
              testing::StartsWith("folder/steps.csv: turn: the marks of the circle run opposite "));
  test = example_linkage();
  test.readings.focus_z.resize(3);
  test.readings.focus_width.resize(3);
  EXPECT_THAT(linkage_problem(test), testing::StartsWith("folder/steps.csv: width: fewer than four widths"));
  test.readings = {};
  EXPECT_THAT(linkage_problem(test), HasSubstr("width_um at four or more positions"));
  test.machine = read_machine(ABBE_SOURCE_DIR "/examples/machines/trunnion-mill.machine.toml");
  EXPECT_THAT(linkage_problem(test), testing::StartsWith("u.machine.toml: the machine has no axis C1; expected axes "));
}

}  // namespace
}  // namespace abbe
