#include "abbe/report/pages/evaluation_data.h"

#include <nlohmann/json.hpp>

#include "abbe/report/evaluations/machine_json.h"

namespace abbe {
namespace {

/// Null where there is none.
nlohmann::json drawn(const std::vector<std::optional<double>>& values) {
  nlohmann::json result = nlohmann::json::array();
  for (const std::optional<double>& value : values) {
    result.push_back(value ? nlohmann::json(for_drawing(*value)) : nlohmann::json());
  }
  return result;
}

nlohmann::json drawn(const std::vector<double>& values) {
  return drawn(std::vector<std::optional<double>>(values.begin(), values.end()));
}

nlohmann::json table_data(const EvaluationTable& table) {
  nlohmann::json data{{"title", table.caption}, {"columns", table.headers}, {"rows", table.rows}};
  if (!table.note.empty()) data["note"] = table.note;
  for (const Sparkline& one : table.sparklines) {
    data["sparklines"].push_back({{"days", one.days},
                                  {"value", drawn(one.value)},
                                  {"expanded_uncertainty", drawn(one.expanded)},
                                  {"control_low", drawn(one.low)},
                                  {"control_high", drawn(one.high)}});
  }
  return data;
}

}  // namespace

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
    place.push_back(table_data(table));
  }
  if (report.page.is_object()) data.update(report.page);
  return data;
}

}  // namespace abbe
