#include "abbe/report/evaluations/expansion_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace abbe {
namespace {

/// Per K, in um/(m K), without the digits that the conversion makes up.
double shown_coefficient(double per_kelvin) { return std::round(per_kelvin * 1e15) / 1e9; }

std::string body_words(const ExpandingBody& body, double low, double high) {
  std::string text = fmt::format("{:.6g} \xC2\xB5m/(m K) at {:.6g}", 1e6 * body.coefficient, low);
  if (high > low) text += fmt::format(" to {:.6g}", high);
  return text + fmt::format(" \xC2\xB0\x43, fixed at {:.6g} mm", body.fixed_point);
}

nlohmann::ordered_json body_json(const ExpandingBody& body, double low, double high) {
  return {{"coefficient_um_per_m_K", shown_coefficient(body.coefficient)},
          {"standard_uncertainty_um_per_m_K", shown_coefficient(body.coefficient_uncertainty)},
          {"temperatures_degC", {low, high}},
          {"temperature_standard_uncertainty_K", body.temperature_uncertainty},
          {"fixed_mm", body.fixed_point}};
}

}  // namespace

void add_expansion(const DifferentialExpansion& expansion, const std::array<bool, 2>& has, const BodyTemperatures& low,
                   const BodyTemperatures& high, EvaluationReport& report) {
  nlohmann::ordered_json json;
  if (has[0]) {
    report.facts.emplace_back("expansion of the machine", body_words(expansion.machine, low.machine, high.machine));
    json["machine"] = body_json(expansion.machine, low.machine, high.machine);
  }
  if (has[1]) {
    report.facts.emplace_back("expansion of the instrument",
                              body_words(expansion.instrument, low.instrument, high.instrument));
    json["instrument"] = body_json(expansion.instrument, low.instrument, high.instrument);
  }
  json["common_temperature_standard_uncertainty_K"] = expansion.common_temperature_uncertainty;
  report.details["expansion"] = std::move(json);
}

void note_exact_expansion(const DifferentialExpansion& expansion, EvaluationReport& report) {
  if (expansion.has_uncertainty()) return;
  report.notes.emplace_back(
      "No uncertainty of coefficients and temperatures was stated: the correction to 20 \xC2\xB0\x43 counts as exact.");
}

}  // namespace abbe
