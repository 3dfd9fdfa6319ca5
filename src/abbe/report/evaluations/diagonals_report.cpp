#include "abbe/report/evaluations/diagonals_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/report/drawings/positioning_plot.h"
#include "abbe/report/evaluations/positioning_report.h"

namespace abbe {
namespace {

EvaluationTable diagonals_table(const std::vector<std::vector<EvaluationFigure>>& figures,
                                const DiagonalsEvaluation& evaluation) {
  EvaluationTable table{"Figures of each diagonal by ISO 230-2, in \xC2\xB5m", {"diagonal"}, {}};
  for (const EvaluationFigure& figure : figures.front()) table.headers.push_back(figure.symbol);
  for (std::size_t i = 0; i < figures.size(); ++i) {
    std::vector<std::string> row = {evaluation.diagonals[i].name};
    for (const EvaluationFigure& figure : figures[i]) {
      row.push_back(figure.value ? figure_text(figure, *figure.value) : "-");
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

EvaluationReport diagonals_report(const DiagonalsEvaluation& evaluation, const std::string& file) {
  EvaluationReport report;
  report.kind = "diagonals";
  report.title = "Diagonal displacement: " + file;
  report.standard = "ISO 230-6:2002, each diagonal by the definitions of ISO 230-2:2014";
  std::string names;
  for (const DiagonalEvaluation& diagonal : evaluation.diagonals) {
    names += (names.empty() ? "" : ", ") + diagonal.name;
  }
  report.facts = {{"diagonals", names}};
  const auto add = [&](const char* symbol, const char* name, const LargestFigure& largest) {
    const std::string& whose = evaluation.diagonals[largest.diagonal].name;
    report.figures.push_back(report_figure(symbol, fmt::format("{}: {}", name, whose), largest.figure));
  };
  add("E_d", "largest bidirectional systematic deviation of a diagonal", evaluation.systematic);
  add("B_d", "largest reversal of a diagonal", evaluation.reversal);
  add("R_d", "largest bidirectional repeatability of a diagonal", evaluation.repeatability);
  add("A_d", "largest bidirectional accuracy of a diagonal", evaluation.accuracy);

  std::vector<std::vector<EvaluationFigure>> figures;
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const DiagonalEvaluation& diagonal : evaluation.diagonals) {
    const PositioningEvaluation& e = diagonal.positioning;
    figures.push_back({report_figure("E", "", e.systematic.figure), report_figure("B", "", e.reversal),
                       report_figure("R", "", e.repeatability.figure), report_figure("A", "", e.accuracy.figure),
                       report_figure("M", "", e.mean_bidirectional.figure)});
    nlohmann::ordered_json entry;
    entry["name"] = diagonal.name;
    // The same writer as for the figures over all, so that units and missing figures look the same.
    EvaluationReport one;
    one.figures = figures.back();
    const nlohmann::ordered_json by_symbol = evaluation_json(one)["figures"];
    for (const auto& [symbol, figure] : by_symbol.items()) {
      if (figure.contains("value_um")) entry[symbol + "_um"] = figure["value_um"];
    }
    entry["targets"] = targets_json(e, false);
    all.push_back(std::move(entry));
    for (const std::string& note : positioning_notes(e, false)) report.notes.push_back(diagonal.name + ": " + note);
  }
  if (evaluation.diagonals.size() != 4 && evaluation.diagonals.size() != 2) {
    report.notes.push_back(
        fmt::format("a test has the four body diagonals or the two diagonals of a face; {} in the file",
                    evaluation.diagonals.size()));
  }
  report.tables.push_back(diagonals_table(figures, evaluation));
  report.plots.push_back({"plot", "", diagonals_plot(evaluation, report.title)});
  report.details["diagonals"] = std::move(all);
  return report;
}

}  // namespace abbe
