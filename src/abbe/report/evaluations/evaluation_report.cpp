#include "abbe/report/evaluations/evaluation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/report/pages/evaluation_data.h"
#include "abbe/report/report.h"

namespace abbe {

double figure_number(const EvaluationFigure& figure, double value) {
  const Unit& unit = unit_named(figure.quantity, figure.unit);
  const double shown = value / unit.factor * std::pow(10, -unit.decimal_shift);
  return std::round(shown * 1e9) / 1e9;
}

std::string EvaluationFigure::verdict() const {
  if (!tolerance) return "";
  if (!value) return "cannot be judged";
  if (exceeds_tolerance()) return is_undecided() ? "exceeded, not proven" : "exceeded";
  return is_undecided() ? "within, not proven" : "within";
}

bool EvaluationFigure::is_undecided() const { return conformity() == Conformity::not_proven; }

Conformity EvaluationFigure::conformity() const {
  if (!tolerance || !value || !uncertainty) return Conformity::not_judged;
  return abbe::conformity(*value, 0.5 * *uncertainty, *tolerance);
}

bool EvaluationReport::exceeds_tolerance() const {
  return std::any_of(figures.begin(), figures.end(),
                     [](const EvaluationFigure& figure) { return figure.exceeds_tolerance(); });
}

std::string figure_text(const EvaluationFigure& figure, double value) {
  std::string text = fmt::format("{:.{}f}", figure_number(figure, value), figure.decimals);
  const bool is_zero = text.find_first_of("123456789") == std::string::npos;
  return is_zero && text.starts_with('-') ? text.substr(1) : text;
}

std::string unit_symbol(const std::string& unit) {
  if (unit == "um") return "\xC2\xB5m";
  if (unit == "um_per_m") return "\xC2\xB5m/m";
  if (unit == "urad") return "\xC2\xB5rad";
  if (unit == "deg") return "\xC2\xB0";
  if (unit == "K_per_h") return "K/h";
  return unit;
}

nlohmann::ordered_json evaluation_json(const EvaluationReport& report) {
  nlohmann::ordered_json json;
  json["format"] = "abbe-evaluation/1";
  json["kind"] = report.kind;
  json["title"] = report.title;
  json["standard"] = report.standard;
  for (const auto& [name, text] : report.facts) json["facts"][name] = text;
  bool tolerances = false;
  for (const EvaluationFigure& figure : report.figures) {
    nlohmann::ordered_json entry;
    entry["name"] = figure.name;
    const auto add = [&](const std::string& key, const std::optional<double>& value) {
      if (!value) return;
      entry[figure.unit.empty() ? key : key + "_" + figure.unit] = figure_number(figure, *value);
    };
    add("value", figure.value);
    if (!figure.value) entry["not_evaluated"] = figure.missing;
    add("expanded_uncertainty", figure.uncertainty);
    add("tolerance", figure.tolerance);
    if (figure.tolerance) entry["verdict"] = figure.verdict();
    tolerances = tolerances || figure.tolerance;
    json["figures"][figure.symbol] = std::move(entry);
  }
  if (tolerances) json["within_tolerance"] = !report.exceeds_tolerance();
  json["notes"] = report.notes;
  if (report.details.is_object()) json.update(report.details);
  return json;
}

std::string evaluation_page(const EvaluationReport& report) { return report_page(evaluation_data(report)); }

}  // namespace abbe
