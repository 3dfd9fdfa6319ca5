#include "abbe/study/evaluations/customer_evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kExamples = ABBE_SOURCE_DIR "/examples/";

Evaluation positioning_of(const std::string& file, const std::vector<ReportTolerance>& tolerances = {}) {
  PositioningTest test;
  test.linear.instrument_per_length = 0.4e-6;
  test.linear.environmental_variation = 0.3e-3;
  test.readings = read_positioning(kExamples + file);
  if (test.readings.rotary) test.linear = {};
  return evaluate_readings({file, test, {}, tolerances});
}

const CustomerFigure& figure_in(const CustomerReport& report, const std::string& symbol) {
  for (const CustomerFigure& figure : report.figures) {
    if (figure.symbol == symbol) return figure;
  }
  throw std::out_of_range(symbol);
}

TEST(CustomerEvaluation, FiguresBeforeAndAfterAreThoseOfBothEvaluations) {
  const Evaluation before = positioning_of("customer_report/before.csv");
  const Evaluation after = positioning_of("customer_report/after.csv", {{"A_mm", 0.006, {}}, {"R+_um", 4, {}}});
  const CustomerReport report = customer_evaluation({}, after, &before, {"before.csv", "after.csv"});
  ASSERT_EQ(report.states.size(), 2U);
  const CustomerFigure& accuracy = figure_in(report, "A");
  EXPECT_NEAR(*accuracy.states[0].value, 1e3 * *before.report.figures[0].value, 1e-9);
  EXPECT_NEAR(*accuracy.states[1].value, 1e3 * *after.report.figures[0].value, 1e-9);
  EXPECT_NEAR(*accuracy.states[1].expanded_uncertainty, 1e3 * *after.report.figures[0].uncertainty, 1e-9);
  EXPECT_EQ(accuracy.tolerance, 6.0) << "in the unit that is shown";
  EXPECT_EQ(figure_in(report, "R↑").tolerance, 4.0);
  EXPECT_EQ(customer_conformity(report, 0, 0), Conformity::nonconformity_proven);
  EXPECT_EQ(customer_conformity(report, 0, 1), Conformity::proven);
  EXPECT_EQ(report.tables.size(), 2U);
  EXPECT_EQ(report.drawings.size(), 2U);
  EXPECT_EQ(report.tables[1].rows.size(), 13U);
}

TEST(CustomerEvaluation, ALoneEvaluationHasOneState) {
  const CustomerReport report = customer_evaluation({}, positioning_of("evaluate/rotary.csv"), nullptr, {});
  EXPECT_EQ(report.subject, "Positioning of a rotary axis");
  EXPECT_EQ(report.figures[0].unit, "″");
  ASSERT_EQ(report.states.size(), 1U);
  EXPECT_EQ(report.tables.size(), 1U);
}

TEST(CustomerEvaluation, NumbersInTheTableFollowTheLanguage) {
  ReportFacts facts;
  facts.language = ReportLanguage::german;
  const CustomerReport report = customer_evaluation(facts, positioning_of("evaluate/linear.csv"), nullptr, {});
  EXPECT_EQ(report.subject, "Positionieren einer Linearachse");
  EXPECT_THAT(report.tables[0].rows[0][1], HasSubstr(","));
}

TEST(CustomerEvaluation, ConditionsAreInTheLanguageOfTheReport) {
  PositioningTest test;
  for (const double target : {0.0, 100.0, 200.0}) {
    test.readings.readings.push_back({target, 1e-3, ApproachDirection::positive});
  }
  const Evaluation evaluation = evaluate_readings({"short.csv", test, {}, {}});
  ReportFacts facts;
  facts.language = ReportLanguage::german;
  const CustomerReport report = customer_evaluation(facts, evaluation, nullptr, {});
  EXPECT_THAT(report.conditions, testing::Contains("ISO 230-2 verlangt mindestens fünf Anfahrten von jeder Seite; hier "
                                                   "sind es an einer Stelle 1."));
  EXPECT_THAT(report.conditions, testing::Contains("ISO 230-2 verlangt mindestens 5 Zielpositionen auf einem Weg von "
                                                   "200 mm; es sind 3."));
  EXPECT_THAT(report.conditions, testing::Contains(HasSubstr("Die Ziele haben gleiche Abstände")));
  EXPECT_THAT(report.conditions, testing::Contains("B: eine Position wurde nur von einer Seite angefahren"));
  EXPECT_THAT(report.notes, testing::IsEmpty());
  EXPECT_FALSE(report.figures[0].states[0].value);
}

TEST(CustomerEvaluation, OfManyTargetsSomeAreShownAndTheCaptionSaysSo) {
  PositioningTest test;
  for (int i = 0; i < 300; ++i) test.readings.readings.push_back({1.0 * i * i, 1e-3, ApproachDirection::positive});
  const Evaluation evaluation = evaluate_readings({"long.csv", test, {}, {}});
  const CustomerTable table = customer_evaluation({}, evaluation, nullptr, {}).tables.front();
  EXPECT_EQ(table.rows.size(), 60U);
  EXPECT_THAT(table.caption, HasSubstr("(60 / 300)"));
  EXPECT_EQ(table.rows.front()[0], "0");
  EXPECT_EQ(table.rows.back()[0], "89401");
  const CustomerReport both = customer_evaluation({}, evaluation, &evaluation, {});
  EXPECT_EQ(both.tables[0].rows.size() + both.tables[1].rows.size(), 60U);
}

TEST(CustomerEvaluation, DiagonalsHaveARowForEachTarget) {
  DiagonalsTest test{read_diagonals(kExamples + "evaluate/diagonals.csv")};
  std::size_t targets = 0;
  const Evaluation evaluation = evaluate_readings({"diagonals.csv", test, {}, {}});
  for (const auto& diagonal : std::get<DiagonalsEvaluation>(evaluation.found).diagonals) {
    targets += diagonal.positioning.targets.size();
  }
  const CustomerReport report = customer_evaluation({}, evaluation, nullptr, {});
  EXPECT_EQ(report.tables[0].rows.size(), targets);
  EXPECT_THAT(report.tables[0].rows[0], testing::SizeIs(report.tables[0].headers.size()));
}

TEST(CustomerEvaluation, EvaluationsThatDoNotBelongTogetherAreRefused) {
  const Evaluation linear = positioning_of("evaluate/linear.csv"), rotary = positioning_of("evaluate/rotary.csv");
  EXPECT_THROW(customer_evaluation({}, linear, &rotary, {}), InputError);
  Evaluation other = linear;
  other.found = Squareness();
  EXPECT_THROW(customer_evaluation({}, other, nullptr, {}), InputError);
}

TEST(CustomerEvaluation, AToleranceOfNoFigureIsRefusedWhereItStands) {
  InputError::Place place;
  place.file = "facts.toml";
  place.line = 7;
  try {
    positioning_of("evaluate/linear.csv", {{"Q_um", 4, place}});
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("facts.toml:7: there is no such figure; expected one of A_um"));
  }
}

}  // namespace
}  // namespace abbe
