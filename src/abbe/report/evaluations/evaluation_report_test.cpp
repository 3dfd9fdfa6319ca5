#include "abbe/report/evaluations/evaluation_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "abbe/report/words/evaluation_text.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::Not;

EvaluationFigure length(const std::string& symbol, double value_mm) {
  EvaluationFigure figure;
  figure.symbol = symbol;
  figure.name = "a length";
  figure.value = value_mm;
  return figure;
}

EvaluationReport small() {
  EvaluationReport report;
  report.kind = "positioning";
  report.title = "a <title>";
  report.standard = "ISO 230-2:2014";
  report.facts = {{"targets", "11"}};
  report.figures = {length("A", 0.0123456)};
  report.notes = {"</li><script>alert(1)</script>"};
  report.tables = {{"targets", {"target", "B"}, {{"<100>", "1.0"}}}};
  report.plots = {{"plot", "all & everything", {"<svg></svg>", ""}}};
  report.details["targets"] = {1, 2};
  return report;
}

TEST(EvaluationText, ShowsTablesThatAreForItWithNumbersInLine) {
  EvaluationReport report = small();
  EXPECT_EQ(evaluation_text(report).find("<100>"), std::string::npos);
  report.tables = {
      {"changes of \u00e4", {"error", "change", "judged"}, {{"EX\u00e4X", "-1.5", "no"}, {"E", "12.5", "yes"}}}};
  report.tables[0].in_text = true;
  EXPECT_THAT(evaluation_text(report), HasSubstr("targets: 11\n\nchanges of \u00e4\n"
                                                 "  error  change  judged\n"
                                                 "  EX\u00e4X     -1.5  no\n"
                                                 "  E        12.5  yes\n\n"));
  report.tables[0].rows.clear();
  EXPECT_THAT(evaluation_text(report), HasSubstr("  error  change  judged\n\n"));
}

TEST(EvaluationFigure, IsShownInItsUnitWithTwoDecimals) {
  EXPECT_EQ(figure_text(length("A", 0.0123456), 0.0123456), "12.35");
  EXPECT_EQ(figure_text(length("A", 0), -1e-9), "0.00");
  EvaluationFigure angle;
  angle.quantity = Quantity::angle;
  angle.unit = "arcsec";
  EXPECT_EQ(figure_text(angle, std::numbers::pi / 180), "3600.00");
}

TEST(EvaluationFigure, ExceedsATolerancePastItsValueAndWithoutAValue) {
  EvaluationFigure figure = length("A", 0.010);
  EXPECT_FALSE(figure.exceeds_tolerance());
  figure.tolerance = 0.010;
  EXPECT_FALSE(figure.exceeds_tolerance()) << "equal is within";
  figure.tolerance = 0.0099;
  EXPECT_TRUE(figure.exceeds_tolerance());
  figure.value.reset();
  figure.tolerance = 1;
  EXPECT_TRUE(figure.exceeds_tolerance());
}

TEST(EvaluationFigure, CloserToItsToleranceThanItsUncertaintyIsUndecided) {
  EvaluationFigure figure = length("A", 0.010);
  figure.tolerance = 0.011;
  EXPECT_FALSE(figure.is_undecided()) << "nothing is known of the uncertainty";
  figure.uncertainty = 0.0005;
  EXPECT_FALSE(figure.is_undecided());
  figure.uncertainty = 0.0015;
  EXPECT_TRUE(figure.is_undecided());
}

TEST(EvaluationReport, JsonHasTheFiguresBySymbolWithTheirUnit) {
  EvaluationReport report = small();
  report.figures[0].tolerance = 0.010;
  report.figures.push_back(length("R", 0));
  report.figures[1].value.reset();
  report.figures[1].missing = "a single run";
  const nlohmann::ordered_json written = evaluation_json(report);
  EXPECT_EQ(written["figures"]["A"]["value_um"], 12.3456);
  EXPECT_EQ(written["figures"]["A"]["tolerance_um"], 10.0);
  EXPECT_EQ(written["figures"]["A"]["verdict"], "exceeded");
  EXPECT_FALSE(written["figures"]["R"].contains("value_um"));
  EXPECT_EQ(written["figures"]["R"]["not_evaluated"], "a single run");
  EXPECT_EQ(written["within_tolerance"], false);
  EXPECT_EQ(written["targets"], (nlohmann::ordered_json{1, 2}));
}

TEST(EvaluationReport, PageIsThatOfAllReportsAndTextInItStaysText) {
  const std::string page = evaluation_page(small());
  EXPECT_THAT(page, testing::StartsWith("<!doctype html>"));
  const std::size_t at = page.find("id=\"abbe-data\">");
  ASSERT_NE(at, std::string::npos);
  const std::string data = page.substr(at, page.find("</script>", at) - at);
  EXPECT_THAT(data, HasSubstr("\"title\":\"a \\u003ctitle>\""));
  EXPECT_THAT(data, HasSubstr("\"value_um\":12.3456"));
  EXPECT_THAT(data, HasSubstr("\\u003csvg>\\u003c/svg>"));
  EXPECT_THAT(data, HasSubstr("\\u003cscript>alert(1)"));
  EXPECT_THAT(data, Not(HasSubstr("<script")));
}

TEST(EvaluationReport, PageSaysWhyAFigureIsMissing) {
  EvaluationReport report = small();
  report.figures[0].value.reset();
  report.figures[0].missing = "only one run";
  EXPECT_THAT(evaluation_page(report), HasSubstr("\"not_evaluated\":\"only one run\""));
}

}  // namespace
}  // namespace abbe
