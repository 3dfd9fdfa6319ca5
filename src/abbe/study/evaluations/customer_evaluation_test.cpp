#include "abbe/study/evaluations/customer_evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"

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

/// One of each of the other kinds, from the examples.
std::vector<Evaluation> other_evaluations() {
  std::vector<Evaluation> all;
  CircularTest circle;
  circle.nominal_radius = 150;
  circle.reading_uncertainty = 0.2e-3;
  circle.feed = 10;
  circle.readings = read_circular(kExamples + "evaluate/circular.csv", circle.nominal_radius);
  all.push_back(evaluate_readings({"circular.csv", circle, {"G_b_um=15"}, {}}));
  RotationTest rotation{read_rotation(kExamples + "evaluate/rotation.csv"), {}};
  rotation.options.plane_distance = 80;
  rotation.options.reading_uncertainty = 0.02e-3;
  all.push_back(evaluate_readings({"rotation.csv", rotation, {}, {}}));
  StraightnessTest line;
  line.readings = read_straightness(kExamples + "evaluate/straightness.csv");
  line.reading_uncertainty = 0.3e-3;
  all.push_back(evaluate_readings({"straightness.csv", line, {"straightness_mz_um=5"}, {}}));
  all.push_back(evaluate_readings(
      {"squareness.csv", SquarenessTest{read_squareness(kExamples + "evaluate/squareness.csv"), {}}, {}, {}}));
  SectionsTest sections;
  sections.readings = read_sections(kExamples + "laser_engraver/sections.csv");
  all.push_back(evaluate_readings({"sections.csv", sections, {}, {}}));
  ContourPointsTest points;
  points.pieces = read_commanded_pieces(kExamples + "laser_engraver/table-a4.csv");
  points.readings = read_point_cloud(kExamples + "laser_engraver/engraved.csv");
  all.push_back(evaluate_readings({"engraved.csv", points, {}, {}}));
  LinkageTest linkage;
  linkage.readings = read_linkage(kExamples + "laser_engraver/five-steps.csv");
  linkage.readings.exit_to_axis = 120;
  linkage.readings.board_thickness = 4;
  all.push_back(evaluate_readings({"five-steps.csv", linkage, {}, {}}));
  EtveTest etve;
  etve.readings = read_thermal(kExamples + "evaluate/etve.csv");
  etve.plane_distance = 150;
  etve.displacement_uncertainty = 1e-4;
  etve.length = 500;
  etve.workpiece_expansion = 23e-6;
  all.push_back(evaluate_readings({"etve.csv", etve, {"ETVE_Z_um=20"}, {}}));
  SpindleDistortionTest spindle;
  spindle.readings = read_thermal(kExamples + "evaluate/spindle.csv");
  spindle.stop = 240 * 60;
  spindle.plane_distance = 150;
  all.push_back(evaluate_readings({"spindle.csv", spindle, {}, {}}));
  AxisDistortionTest axis{read_axis_distortion(kExamples + "evaluate/axis_warming.csv"), 1e-4, 0};
  all.push_back(evaluate_readings({"axis_warming.csv", axis, {}, {}}));
  return all;
}

bool is_ascii(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80U; });
}

TEST(CustomerEvaluation, EveryKindHasItsFiguresWithNamesInEveryLanguage) {
  for (const Evaluation& evaluation : other_evaluations()) {
    SCOPED_TRACE(evaluation.report.title);
    std::vector<CustomerReport> reports;
    for (int language = 0; language < kReportLanguageCount; ++language) {
      ReportFacts facts;
      facts.language = static_cast<ReportLanguage>(language);
      reports.push_back(customer_evaluation(facts, evaluation, nullptr, {"a.csv"}));
    }
    ASSERT_EQ(reports[0].figures.size(), evaluation.report.figures.size());
    for (std::size_t i = 0; i < reports[0].figures.size(); ++i) {
      const EvaluationFigure& figure = evaluation.report.figures[i];
      const CustomerFigure& shown = reports[0].figures[i];
      EXPECT_EQ(shown.name, figure.name) << "the same words as in English";
      EXPECT_NE(reports[1].figures[i].name, figure.name) << figure.symbol;
      EXPECT_FALSE(is_ascii(reports[2].figures[i].name)) << figure.symbol;
      EXPECT_FALSE(is_ascii(reports[3].figures[i].name)) << figure.symbol;
      EXPECT_EQ(reports[3].figures[i].name.find("{}"), std::string::npos) << reports[3].figures[i].name;
      ASSERT_EQ(shown.states.size(), 1U);
      EXPECT_EQ(shown.states[0].value.has_value(), figure.value.has_value());
      if (figure.value) {
        EXPECT_EQ(*shown.states[0].value, figure_number(figure, *figure.value));
      }
      EXPECT_EQ(shown.states[0].expanded_uncertainty.has_value(), figure.value && figure.uncertainty);
      EXPECT_EQ(shown.tolerance.has_value(), figure.tolerance.has_value());
    }
    for (const CustomerReport& report : reports) {
      EXPECT_EQ(report.tables.empty(), evaluation.report.kind == "linkage");
      EXPECT_EQ(report.drawings.empty(), evaluation.report.kind == "linkage");
      for (const CustomerTable& table : report.tables) {
        EXPECT_FALSE(table.rows.empty());
        for (const auto& row : table.rows) EXPECT_THAT(row, testing::SizeIs(table.headers.size()));
        EXPECT_LE(table.rows.size(), 60U);
      }
    }
    EXPECT_NE(reports[0].subject, reports[1].subject);
    EXPECT_FALSE(is_ascii(reports[2].subject));
  }
}

TEST(CustomerEvaluation, CircularTestsShowTheReadingNearestToEachAngle) {
  CircularTest test;
  test.nominal_radius = 100;
  // An offset along X of 5 um as the instrument sees it, one direction, not at angles near 180 degrees.
  for (int degrees = 0; degrees < 360; degrees += 5) {
    if (degrees > 165 && degrees < 195) continue;
    test.readings.paths[1].angle.push_back((degrees + 1.0) * kDegree);
    test.readings.paths[1].radius.push_back(100 + 5e-3 * std::cos((degrees + 1.0) * kDegree));
  }
  test.centre = CircularCentre::instrument;
  const Evaluation evaluation = evaluate_readings({"circle.csv", test, {}, {}});
  const CustomerReport report = customer_evaluation({}, evaluation, nullptr, {});
  const CustomerTable& table = report.tables.at(0);
  ASSERT_EQ(table.rows.size(), 23U) << "none near 180 degrees";
  EXPECT_THAT(table.rows[0], ElementsAre("0", "–", "5.00"));
  EXPECT_THAT(table.rows[6], ElementsAre("90", "–",
                                         "\xE2\x88\x92"
                                         "0.09"));
  EXPECT_EQ(table.rows[12][0], "195");
  EXPECT_THAT(report.conditions, testing::Contains("Centre: instrument"));
  EXPECT_THAT(report.conditions, testing::Contains("Plane: XY"));
}

TEST(CustomerEvaluation, LinesShowTheirDeviationsInTheOrderOfTheirPositions) {
  StraightnessTest test;
  test.readings.positions = {200, 0, 100, 300};
  test.readings.deviations = {-1e-3, 1e-3, 1e-3, -1e-3};
  const Evaluation evaluation = evaluate_readings({"line.csv", test, {"straightness_mz_um=2"}, {}});
  ReportFacts facts;
  facts.language = ReportLanguage::german;
  const CustomerReport report = customer_evaluation(facts, evaluation, nullptr, {});
  const CustomerTable& table = report.tables.at(0);
  ASSERT_EQ(table.rows.size(), 4U);
  EXPECT_THAT(table.headers,
              ElementsAre("Position / mm", "von der Ausgleichsgeraden / µm", "von der Minimumzone / µm"));
  EXPECT_EQ(table.rows[0][0], "0");
  EXPECT_EQ(table.rows[1][0], "100");
  // The least-squares line falls by 0.8 um in 100 mm from 1.2 um.
  EXPECT_EQ(table.rows[0][1],
            "\xE2\x88\x92"
            "0,20");
  EXPECT_EQ(table.rows[1][1], "0,60");
  EXPECT_EQ(table.caption, "Abweichungen von der Bezugsgeraden");
  EXPECT_EQ(customer_conformity(report, 1, 0), Conformity::not_judged) << "no uncertainty of a reading is stated";
}

TEST(CustomerEvaluation, LinesOfASquarenessTestNameTheirReference) {
  SquarenessTest test{read_squareness(kExamples + "evaluate/squareness.csv"), {}};
  const auto header_of = [&] {
    const Evaluation evaluation = evaluate_readings({"squareness.csv", test, {}, {}});
    return customer_evaluation({}, evaluation, nullptr, {}).tables.at(1).headers.at(1);
  };
  EXPECT_EQ(header_of(), "from least-squares line / µm");
  test.options.reference = ReferenceLine::minimum_zone;
  EXPECT_EQ(header_of(), "from minimum zone / µm");
}

TEST(CustomerEvaluation, SectionsWithoutPlacesAreDrawnByTheirNumbers) {
  SectionsTest test;
  test.readings = read_sections(kExamples + "laser_engraver/sections.csv");
  const auto drawing_of = [&] {
    const Evaluation evaluation = evaluate_readings({"sections.csv", test, {}, {}});
    return customer_evaluation({}, evaluation, nullptr, {}).drawings.at(0).svg;
  };
  EXPECT_THAT(drawing_of(), HasSubstr("along the curve / mm"));
  test.readings.back().along.reset();
  EXPECT_THAT(drawing_of(), testing::AllOf(HasSubstr(">Section<"), testing::Not(HasSubstr("along the curve"))));
}

TEST(CustomerEvaluation, NotesSayWhatIsMissingBeforeTheCorrection) {
  SectionsTest test;
  test.readings = read_sections(kExamples + "laser_engraver/sections.csv");
  const Evaluation after = evaluate_readings({"after.csv", test, {}, {}});
  EXPECT_THAT(customer_evaluation({}, after, nullptr, {}).notes, testing::Not(testing::Contains(HasSubstr("before:"))));
  Evaluation before = after;
  before.refused = "1 of 2 sections could not be evaluated";
  before.report.figures[0].value.reset();
  before.report.figures[0].missing = "why";
  const CustomerReport report = customer_evaluation({}, after, &before, {});
  EXPECT_THAT(report.notes, testing::Contains("before: 1 of 2 sections could not be evaluated."));
  EXPECT_THAT(report.notes, testing::Contains("before: " + before.report.figures[0].symbol + ": why."));
  EXPECT_TRUE(report.refusals.empty());
}

TEST(CustomerEvaluation, OtherKindsCompareTwoStatesOfTheSameAxes) {
  CircularTest test;
  test.nominal_radius = 150;
  test.reading_uncertainty = 0.2e-3;
  test.readings = read_circular(kExamples + "evaluate/circular.csv", test.nominal_radius);
  const Evaluation before = evaluate_readings({"before.csv", test, {}, {}});
  for (CircularReadings& path : test.readings.paths) {
    for (double& radius : path.radius) radius = 150 + 0.1 * (radius - 150);
  }
  const Evaluation after = evaluate_readings({"after.csv", test, {"G_b_um=15"}, {}});
  const CustomerReport report = customer_evaluation({}, after, &before, {});
  ASSERT_EQ(report.states.size(), 2U);
  const CustomerFigure& both = figure_in(report, "G_b");
  EXPECT_NEAR(*both.states[1].value, 0.1 * *both.states[0].value, 0.02 * *both.states[0].value);
  EXPECT_EQ(customer_conformity(report, 6, 1), Conformity::proven);
  test.plane = "YZ";
  test.readings.plane = "";
  const Evaluation other = evaluate_readings({"other.csv", test, {}, {}});
  EXPECT_THROW(customer_evaluation({}, after, &other, {}), InputError) << "of other axes";
}

TEST(CustomerEvaluation, EvaluationsThatDoNotBelongTogetherAreRefused) {
  const Evaluation linear = positioning_of("evaluate/linear.csv"), rotary = positioning_of("evaluate/rotary.csv");
  EXPECT_THROW(customer_evaluation({}, linear, &rotary, {}), InputError);
  Evaluation other = linear;
  other.found = Squareness();
  EXPECT_THROW(customer_evaluation({}, linear, &other, {}), InputError);
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
