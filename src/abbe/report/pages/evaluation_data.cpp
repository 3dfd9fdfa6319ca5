#include "abbe/report/pages/evaluation_data.h"

#include <nlohmann/json.hpp>

namespace abbe {

nlohmann::json drawing_data(const EvaluationPlot& plot) {
  if (plot.beside) return {{"caption", plot.caption}, {"svg", plot.picture.narrow}, {"beside", true}};
  return {{"caption", plot.caption}, {"svg", plot.picture.wide}, {"svg_narrow", plot.picture.narrow}};
}

nlohmann::json evaluation_data(const EvaluationReport& report) {
  const nlohmann::ordered_json whole = evaluation_json(report);
  nlohmann::json data;
  data["format"] = "abbe-report/1";
  data["title"] = report.title;
  data["subtitle"] = report.standard;
  nlohmann::json& evaluation = data["evaluation"];
  evaluation["kind"] = report.kind;
  evaluation["facts"] = nlohmann::json::array();
  for (const auto& [name, text] : report.facts) evaluation["facts"].push_back({{"name", name}, {"text", text}});
  evaluation["figures"] = nlohmann::json::array();
  for (const EvaluationFigure& figure : report.figures) {
    nlohmann::json entry = whole["figures"][figure.symbol];
    entry["symbol"] = figure.symbol;
    entry["decimals"] = figure.decimals;
    evaluation["figures"].push_back(std::move(entry));
  }
  // A distribution in the data is drawn by the page itself.
  if (!report.page.is_object() || !report.page.contains("histograms")) {
    for (const EvaluationPlot& plot : report.plots) {
      if (plot.in_page && report.page.is_object()) continue;
      evaluation["drawings"].push_back(drawing_data(plot));
    }
  }
  data["assumptions"] = report.notes;
  data["tables"] = nlohmann::json::array();
  for (const EvaluationTable& table : report.tables) {
    nlohmann::json& place = table.with_figures ? evaluation["tables"] : data["tables"];
    place.push_back({{"title", table.caption}, {"columns", table.headers}, {"rows", table.rows}});
  }
  if (report.page.is_object()) data.update(report.page);
  return data;
}

}  // namespace abbe
