#include "abbe/report/pages/evaluation_data.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "abbe/report/report.h"

namespace abbe {
namespace {

EvaluationReport small_report() {
  EvaluationReport report;
  report.kind = "deviation";
  report.title = "Deviation of a from b";
  report.standard = "signed distance";
  report.facts = {{"scan", "3 points"}, {"part", "12 triangles"}};
  EvaluationFigure rms;
  rms.symbol = "rms";
  rms.name = "root mean square";
  rms.value = 0.0125;
  rms.tolerance = 0.01;
  EvaluationFigure mean;
  mean.symbol = "mean";
  mean.name = "mean";
  mean.missing = "no point counts";
  report.figures = {rms, mean};
  report.tables = {{"By faces", {"face", "rms"}, {{"1", "12.50"}}},
                   {"By axes", {"axis", "rms"}, {{"X", "3.10"}}, /*with_figures=*/true}};
  report.notes = {"a note"};
  report.plots = {{"plot", "by angle", {"<svg/>", "<svg width=\"320\"/>"}}};
  report.page = {{"surface", {{"frame", "part"}}}};
  return report;
}

TEST(EvaluationData, HoldsTheFiguresOfTheEvaluationInTheirOrder) {
  const EvaluationReport report = small_report();
  const nlohmann::json data = evaluation_data(report);
  EXPECT_EQ(data.at("title"), report.title);
  EXPECT_EQ(data.at("surface").at("frame"), "part");
  EXPECT_EQ(data.at("assumptions").at(0), "a note");
  EXPECT_EQ(data.at("tables").at(0).at("rows").at(0).at(1), "12.50");
  const nlohmann::json& evaluation = data.at("evaluation");
  EXPECT_EQ(evaluation.at("facts").at(1).at("text"), "12 triangles");
  EXPECT_EQ(data.at("tables").size(), 1U);
  EXPECT_EQ(evaluation.at("tables").at(0).at("title"), "By axes");
  ASSERT_EQ(evaluation.at("figures").size(), 2U);
  const nlohmann::json& rms = evaluation.at("figures").at(0);
  EXPECT_EQ(rms.at("symbol"), "rms");
  EXPECT_EQ(rms.at("value_um").get<double>(), evaluation_json(report)["figures"]["rms"]["value_um"].get<double>());
  EXPECT_EQ(rms.at("value_um"), 12.5);
  EXPECT_EQ(rms.at("verdict"), "exceeded");
  EXPECT_EQ(evaluation.at("figures").at(1).at("not_evaluated"), "no point counts");
  EXPECT_EQ(evaluation.at("drawings").at(0).at("svg"), "<svg/>");
  EXPECT_EQ(evaluation.at("drawings").at(0).at("svg_narrow"), "<svg width=\"320\"/>");
  EXPECT_NO_THROW(report_page(data));
  EvaluationPlot one_of_many = report.plots.front();
  one_of_many.beside = true;
  EXPECT_EQ(drawing_data(one_of_many).at("svg"), "<svg width=\"320\"/>");
  EXPECT_EQ(drawing_data(one_of_many).at("beside"), true);
  EXPECT_FALSE(drawing_data(one_of_many).contains("svg_narrow"));
  EvaluationReport other = report;
  other.page["histograms"] = nlohmann::json::array();
  EXPECT_FALSE(evaluation_data(other).at("evaluation").contains("drawings"));
}

}  // namespace
}  // namespace abbe
