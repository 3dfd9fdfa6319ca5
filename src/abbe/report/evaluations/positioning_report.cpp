#include "abbe/report/evaluations/positioning_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "abbe/geometry/angle_units.h"
#include "abbe/report/drawings/positioning_plot.h"
#include "abbe/report/evaluations/positioning_correction_report.h"

namespace abbe {
namespace {

/// um or arcsec, without the digits that the conversion makes up.
double shown_deviation(double value, bool rotary) {
  return std::round(value * (rotary ? 1 / kArcsec : 1e3) * 1e9) / 1e9;
}

double rounded_position(double value, bool rotary) {
  return std::round(value * (rotary ? 1 / kDegree : 1) * 1e9) / 1e9;
}

std::vector<EvaluationFigure> figures(const PositioningEvaluation& e, bool rotary, const PositioningUncertainty* u,
                                      const PositioningCorrection* correction = nullptr) {
  std::vector<EvaluationFigure> all;
  const PositioningUncertainty none;
  const PositioningUncertainty& v = u != nullptr ? *u : none;
  const bool stated = u != nullptr || (correction != nullptr && correction->expansion.has_uncertainty());
  const auto values = positioning_figures(e);
  const auto add = [&](const char* symbol, const char* name, double uncertainty) {
    const std::size_t f = all.size();
    all.push_back(report_figure(symbol, name, values[f], rotary));
    if (!stated || !values[f].is_evaluated()) return;
    // None of what was stated affects it: that is no uncertainty of 0.
    const double whole = correction == nullptr ? uncertainty : std::hypot(uncertainty, correction->expanded[f]);
    if (whole > 0) all.back().uncertainty = whole;
  };
  add("A", "bidirectional accuracy", v.accuracy);
  add("A+", "unidirectional accuracy, positive approach", v.accuracy);
  add("A-", "unidirectional accuracy, negative approach", v.accuracy);
  add("E", "bidirectional systematic deviation", v.systematic);
  add("E+", "systematic deviation, positive approach", v.systematic);
  add("E-", "systematic deviation, negative approach", v.systematic);
  add("M", "range of the mean bidirectional deviation", v.mean_bidirectional);
  add("R", "bidirectional repeatability", v.repeatability);
  add("R+", "repeatability, positive approach", v.unidirectional_repeatability);
  add("R-", "repeatability, negative approach", v.unidirectional_repeatability);
  add("B", "reversal, largest", v.reversal);
  add("B_mean", "reversal, mean", v.reversal);
  return all;
}

EvaluationTable targets_table(const PositioningEvaluation& evaluation, bool rotary) {
  const char* const unit = rotary ? "arcsec" : "\xC2\xB5m";
  EvaluationTable table;
  table.caption = fmt::format("Target positions in {}, all else in {}", rotary ? "\xC2\xB0" : "mm", unit);
  table.headers = {
      "target", "n+", "n\xE2\x88\x92", "mean+", "mean\xE2\x88\x92", "s+", "s\xE2\x88\x92", "R+", "R\xE2\x88\x92",
      "B",      "R",  "mean"};
  for (const PositioningTarget& target : evaluation.targets) {
    const auto text = [&](double value) { return fmt::format("{:.2f}", shown_deviation(value, rotary)); };
    const auto figure = [&](const EvaluatedFigure& f) { return f.is_evaluated() ? text(f.value) : std::string("-"); };
    const auto mean = [&](std::size_t k) { return target.runs[k] > 0 ? text(target.mean[k]) : std::string("-"); };
    const auto s = [&](std::size_t k) { return target.runs[k] > 1 ? text(target.deviation[k]) : std::string("-"); };
    table.rows.push_back({fmt::format("{:.6g}", rounded_position(target.position, rotary)),
                          std::to_string(target.runs[0]), std::to_string(target.runs[1]), mean(0), mean(1), s(0), s(1),
                          figure(target.repeatability[0]), figure(target.repeatability[1]), figure(target.reversal),
                          figure(target.bidirectional_repeatability), figure(target.mean_bidirectional)});
  }
  return table;
}

/// True if three or more targets stand at the same distance from each other.
bool equally_spaced(const std::vector<PositioningTarget>& targets) {
  if (targets.size() < 3) return false;
  const double step = targets[1].position - targets[0].position;
  for (std::size_t i = 2; i < targets.size(); ++i) {
    if (std::abs(targets[i].position - targets[i - 1].position - step) > 1e-6 * step) return false;
  }
  return true;
}

}  // namespace

EvaluationFigure report_figure(const std::string& symbol, const std::string& name, const EvaluatedFigure& figure,
                               bool rotary) {
  EvaluationFigure result;
  result.symbol = symbol;
  result.name = name;
  result.quantity = rotary ? Quantity::angle : Quantity::length;
  result.unit = rotary ? "arcsec" : "um";
  if (figure.is_evaluated()) {
    result.value = figure.value;
  } else {
    result.missing = std::string(figure_status_words(figure.status));
  }
  return result;
}

std::vector<PositioningShortfall> positioning_shortfalls(const PositioningEvaluation& evaluation, bool rotary) {
  using Kind = PositioningShortfall::Kind;
  std::vector<PositioningShortfall> found;
  const double span = rounded_position(evaluation.span(), rotary);
  const std::string fewest = std::to_string(evaluation.fewest_runs);
  if ((rotary || span <= 2000) && evaluation.fewest_runs < 5) found.push_back({Kind::few_runs, {fewest}});
  if (evaluation.fewest_runs != evaluation.most_runs) {
    found.push_back({Kind::uneven_runs, {fewest, std::to_string(evaluation.most_runs)}});
  }
  std::size_t wanted = 0;
  if (rotary) {
    wanted = span <= 90 ? 3 : span <= 180 ? 5 : 8;
  } else if (span <= 2000) {
    wanted = std::max<std::size_t>(5, static_cast<std::size_t>(std::ceil(5 * span / 1000)));
  }
  if (evaluation.targets.size() < wanted) {
    found.push_back({Kind::few_targets,
                     {std::to_string(wanted), fmt::format("{:.6g} {}", span, rotary ? "\xC2\xB0" : "mm"),
                      std::to_string(evaluation.targets.size())}});
  }
  if (equally_spaced(evaluation.targets)) found.push_back({Kind::equal_spacing, {}});
  return found;
}

std::vector<std::string> positioning_notes(const PositioningEvaluation& evaluation, bool rotary) {
  using Kind = PositioningShortfall::Kind;
  std::vector<std::string> notes;
  for (const PositioningShortfall& one : positioning_shortfalls(evaluation, rotary)) {
    const std::vector<std::string>& n = one.numbers;
    switch (one.kind) {
      case Kind::few_runs:
        notes.push_back("ISO 230-2 asks for at least five runs from each side; the fewest here is " + n[0]);
        break;
      case Kind::uneven_runs:
        notes.push_back(
            fmt::format("the number of readings from one side differs between positions: {} to {}", n[0], n[1]));
        break;
      case Kind::few_targets:
        notes.push_back(fmt::format("ISO 230-2 asks for at least {} target positions on a travel of {}; there are {}",
                                    n[0], n[1], n[2]));
        break;
      case Kind::equal_spacing:
        notes.emplace_back(
            "the targets are equally spaced: deviations that repeat with their distance or a whole fraction of it "
            "(pitch of a screw, of a scale) do not show");
        break;
    }
  }
  return notes;
}

nlohmann::ordered_json targets_json(const PositioningEvaluation& evaluation, bool rotary) {
  const std::string unit = rotary ? "_arcsec" : "_um";
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const PositioningTarget& target : evaluation.targets) {
    nlohmann::ordered_json entry;
    entry[rotary ? "position_deg" : "position_mm"] = rounded_position(target.position, rotary);
    for (const std::size_t k : {0U, 1U}) {
      const std::string side = k == 0 ? "positive" : "negative";
      entry["runs_" + side] = target.runs[k];
      if (target.runs[k] > 0) entry["mean_" + side + unit] = shown_deviation(target.mean[k], rotary);
      if (target.runs[k] > 1) entry["s_" + side + unit] = shown_deviation(target.deviation[k], rotary);
    }
    const auto add = [&](const char* key, const EvaluatedFigure& figure) {
      if (figure.is_evaluated()) entry[key + unit] = shown_deviation(figure.value, rotary);
    };
    add("reversal", target.reversal);
    add("mean_bidirectional", target.mean_bidirectional);
    add("repeatability", target.bidirectional_repeatability);
    all.push_back(std::move(entry));
  }
  return all;
}

namespace {

void add_contributions(const PositioningUncertainty* uncertainty, const PositioningCorrection* correction, bool rotary,
                       EvaluationReport& report) {
  const bool of_correction = correction != nullptr && !correction->contributions.empty();
  if (uncertainty == nullptr && !of_correction) return;
  const std::string unit = rotary ? "arcsec" : "um";
  EvaluationTable table{"Contributions to the measurement uncertainty, expanded (k = 2)", {"contribution", unit}, {}};
  nlohmann::ordered_json contributions = nlohmann::ordered_json::array();
  const auto add = [&](const std::vector<PositioningUncertainty::Contribution>& all) {
    for (const auto& contribution : all) {
      const double shown = shown_deviation(contribution.expanded, rotary);
      table.rows.push_back({contribution.name, fmt::format("{:.2f}", shown)});
      contributions.push_back({{"name", contribution.name}, {"expanded_uncertainty_" + unit, shown}});
    }
  };
  if (uncertainty != nullptr) add(uncertainty->contributions);
  if (of_correction) add(correction->contributions);
  report.tables.push_back(std::move(table));
  report.details["uncertainty_contributions"] = std::move(contributions);
}

/// Says which figures have no uncertainty, where others have one.
void add_unknown_uncertainties(bool rotary, EvaluationReport& report) {
  std::string without;
  bool any = false;
  for (const EvaluationFigure& figure : report.figures) {
    any = any || figure.uncertainty;
    if (figure.value && !figure.uncertainty) without += (without.empty() ? "" : ", ") + figure.symbol;
  }
  if (!any || without.empty()) return;
  report.notes.push_back(
      fmt::format("No stated contribution affects {}: their uncertainty is not known. The range of the indication at "
                  "rest does (--environment-{}).",
                  without, rotary ? "arcsec" : "um"));
}

}  // namespace

EvaluationReport positioning_report(const PositioningEvaluation& evaluation, bool rotary, const std::string& file,
                                    const PositioningUncertainty* uncertainty,
                                    const PositioningCorrection* correction) {
  EvaluationReport report;
  report.kind = "positioning";
  report.title = "Positioning: " + std::filesystem::path(file).filename().string();
  report.standard = "ISO 230-2:2014";
  const auto& targets = evaluation.targets;
  report.facts = {
      {"axis", rotary ? "rotary" : "linear"},
      {"targets",
       fmt::format("{} from {:.6g} to {:.6g} {}", targets.size(), rounded_position(targets.front().position, rotary),
                   rounded_position(targets.back().position, rotary), rotary ? "\xC2\xB0" : "mm")},
      {"runs from one side", evaluation.fewest_runs == evaluation.most_runs
                                 ? std::to_string(evaluation.most_runs)
                                 : fmt::format("{} to {}", evaluation.fewest_runs, evaluation.most_runs)}};
  report.figures = figures(evaluation, rotary, uncertainty, correction);
  report.notes = positioning_notes(evaluation, rotary);
  add_unknown_uncertainties(rotary, report);
  report.tables.push_back(targets_table(evaluation, rotary));
  report.plots.push_back({"plot", "", positioning_plot(evaluation, rotary, report.title)});
  report.details["targets"] = targets_json(evaluation, rotary);
  if (correction != nullptr) add_correction(*correction, evaluation, report);
  add_contributions(uncertainty, correction, rotary, report);
  return report;
}

}  // namespace abbe
