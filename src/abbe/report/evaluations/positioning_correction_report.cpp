#include "abbe/report/evaluations/positioning_correction_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/report/evaluations/expansion_report.h"

namespace abbe {
namespace {

double in_um_of_report(double mm) { return std::round(mm * 1e12) / 1e9; }

/// Means of both sides, as read and corrected.
EvaluationTable means_table(const PositioningEvaluation& as_read, const PositioningEvaluation& corrected) {
  EvaluationTable table;
  table.caption =
      "Mean deviations as read and corrected to 20 \xC2\xB0\x43; target positions in mm, all else in \xC2\xB5m";
  table.headers = {"target", "mean+ as read", "mean+ at 20 \xC2\xB0\x43", "mean\xE2\x88\x92 as read",
                   "mean\xE2\x88\x92 at 20 \xC2\xB0\x43"};
  for (std::size_t i = 0; i < corrected.targets.size(); ++i) {
    std::vector<std::string> row = {fmt::format("{:.6g}", corrected.targets[i].position)};
    for (const std::size_t side : {0U, 1U}) {
      for (const PositioningEvaluation* const one : {&as_read, &corrected}) {
        const PositioningTarget& target = one->targets[i];
        row.push_back(target.runs[side] > 0 ? fmt::format("{:.2f}", in_um_of_report(target.mean[side])) : "-");
      }
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

EvaluationTable figures_table(const PositioningEvaluation& as_read, const EvaluationReport& report) {
  EvaluationTable table{"Figures as read and corrected to 20 \xC2\xB0\x43, in \xC2\xB5m",
                        {"figure", "as read", "at 20 \xC2\xB0\x43"},
                        {}};
  const auto values = positioning_figures(as_read);
  for (std::size_t f = 0; f < values.size(); ++f) {
    const EvaluationFigure& figure = report.figures[f];
    if (!values[f].is_evaluated() || !figure.value) continue;
    table.rows.push_back({figure.symbol, fmt::format("{:.2f}", in_um_of_report(values[f].value)),
                          fmt::format("{:.2f}", in_um_of_report(*figure.value))});
  }
  return table;
}

nlohmann::ordered_json as_read_json(const PositioningEvaluation& as_read, const EvaluationReport& report) {
  nlohmann::ordered_json json;
  const auto values = positioning_figures(as_read);
  for (std::size_t f = 0; f < values.size(); ++f) {
    if (values[f].is_evaluated()) json[report.figures[f].symbol + "_um"] = in_um_of_report(values[f].value);
  }
  json["targets"] = targets_json(as_read, false);
  return json;
}

}  // namespace

void add_correction(const PositioningCorrection& correction, const PositioningEvaluation& corrected,
                    EvaluationReport& report) {
  const BodyTemperatures &low = correction.lowest, &high = correction.highest;
  add_expansion(correction.expansion, {correction.has_machine, correction.has_instrument}, low, high, report);
  report.notes.emplace_back(
      "The deviations are corrected to 20 \xC2\xB0\x43 for the nominal differential expansion of machine and "
      "instrument "
      "(ISO 230-2).");
  note_exact_expansion(correction.expansion, report);
  report.tables.push_back(figures_table(correction.as_read, report));
  report.tables.push_back(means_table(correction.as_read, corrected));
  report.details["as_read"] = as_read_json(correction.as_read, report);
}

}  // namespace abbe
