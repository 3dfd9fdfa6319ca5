#include "abbe/report/evaluations/thermal_figures.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

/// A longer time between readings is noted, s.
constexpr double kLongGap = 900;
constexpr double kMinute = 60;

std::string missing_range(ThermalStatus status) {
  switch (status) {
    case ThermalStatus::not_run:
      return "not run";
    case ThermalStatus::done:
      return "";
    case ThermalStatus::too_short:
      return "the readings last less than an hour";
    case ThermalStatus::gap:
      return "there is no reading for more than half an hour";
  }
  return "";
}

}  // namespace

std::string change_words(double value, bool is_angle) {
  const double shown = micro_per_unit(is_angle) * value;
  return fmt::format("{:.2f} {}", std::abs(shown) < 0.005 ? 0 : shown, is_angle ? "\xC2\xB5rad" : "\xC2\xB5m");
}

std::string duration_words(double seconds) {
  const double minutes = std::round(seconds / kMinute);
  if (minutes < 1) return fmt::format("{:.3g} s", seconds);
  if (minutes < 60) return fmt::format("{:.0f} min", minutes);
  const double hours = std::floor(minutes / 60);
  return minutes == 60 * hours ? fmt::format("{:.0f} h", hours)
                               : fmt::format("{:.0f} h {:.0f} min", hours, minutes - 60 * hours);
}

EvaluationFigure thermal_figure(const std::string& symbol, const std::string& name, const ThermalFigure& figure,
                                bool is_angle, const std::string& about) {
  EvaluationFigure result;
  result.symbol = symbol;
  result.name = name;
  if (is_angle) {
    result.quantity = Quantity::angle;
    result.unit = "urad";
  }
  if (figure.is_evaluated()) {
    result.value = figure.value;
    if (figure.uncertainty > 0) result.uncertainty = 2 * figure.uncertainty;
  } else {
    result.missing = missing_range(figure.status);
  }
  result.about = {about};
  return result;
}

std::string response_words(ResponseStatus status) {
  switch (status) {
    case ResponseStatus::not_run:
      return "not run";
    case ResponseStatus::done:
      return "";
    case ResponseStatus::too_few_readings:
      return "too few readings that are independent of each other";
    case ResponseStatus::no_change:
      return "no change beyond the scatter of the readings";
    case ResponseStatus::not_first_order:
      return "the readings do not follow a first-order response";
    case ResponseStatus::not_identified:
      return "the readings do not bound it: they end too early or are too far apart";
  }
  return "";
}

EvaluationFigure time_constant_figure(const std::string& symbol, const std::string& name,
                                      const FirstOrderResponse& response, const std::string& about) {
  EvaluationFigure result;
  result.symbol = symbol;
  result.name = name;
  result.quantity = Quantity::time;
  result.unit = "min";
  if (response.status == ResponseStatus::done) {
    result.value = response.time_constant;
    result.uncertainty = 2 * response.uncertainty;
  } else {
    result.missing = response_words(response.status);
  }
  result.about = {about};
  return result;
}

nlohmann::ordered_json response_json(const FirstOrderResponse& response, bool is_angle) {
  if (response.status != ResponseStatus::done) return {{"not_evaluated", response_words(response.status)}};
  const std::string unit = is_angle ? "_urad" : "_um";
  const double micro = micro_per_unit(is_angle);
  return {{"time_constant_min", response.time_constant / kMinute},
          {"expanded_uncertainty_min", 2 * response.uncertainty / kMinute},
          {"final_change" + unit, micro * response.change},
          {"residual_rms" + unit, micro * response.residual_rms},
          {"correlation_length", response.correlation_length}};
}

void add_thermal_notes(bool is_stated, bool lacks_distance, const std::vector<const TimeSeries*>& series,
                       EvaluationReport& report) {
  if (!is_stated) {
    report.notes.push_back(
        "No uncertainty of the readings was stated (--u-reading-um): ranges have no measurement uncertainty.");
  }
  if (lacks_distance) {
    report.notes.push_back(
        "Sensors in two planes show tilts if the distance of the planes is stated (--plane-distance-mm).");
  }
  const TimeSeries* longest = nullptr;
  double gap = kLongGap * (1 + 1e-9);
  for (const TimeSeries* const one : series) {
    const double of_one = longest_gap(*one, one->from(), one->to());
    if (of_one <= gap) continue;
    gap = of_one;
    longest = one;
  }
  if (longest != nullptr) {
    report.notes.push_back(fmt::format("{} was not read for {}: it is interpolated linearly in between.", longest->name,
                                       duration_words(gap)));
  }
}

}  // namespace abbe
