#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/report/drawings/thermal_plot.h"
#include "abbe/report/evaluations/thermal_figures.h"
#include "abbe/report/evaluations/thermal_report.h"

namespace abbe {
namespace {

EvaluationFigure temperature_figure(const std::string& symbol, const std::string& name, const ThermalFigure& figure,
                                    const std::string& about) {
  EvaluationFigure result = thermal_figure(symbol, name, figure, false, about);
  result.quantity = Quantity::temperature_difference;
  result.unit = "K";
  return result;
}

/// A change within an hour as a rate.
EvaluationFigure rate_figure(const std::string& symbol, const std::string& name, ThermalFigure change,
                             const std::string& about) {
  change.value /= kHour;
  change.uncertainty /= kHour;
  EvaluationFigure result = thermal_figure(symbol, name, change, false, about);
  result.quantity = Quantity::temperature_rate;
  result.unit = "K_per_h";
  return result;
}

void add_length(const LengthTemperatureInput& input, const LengthUncertainty& found, EvaluationReport& report) {
  report.facts.emplace_back("measured length", fmt::format("{:.6g} mm", input.length));
  report.facts.emplace_back("temperature of the workpiece",
                            fmt::format("{:.4g} \xC2\xB0\x43", input.workpiece_temperature));
  report.facts.emplace_back("temperature of the scale", fmt::format("{:.4g} \xC2\xB0\x43", input.scale_temperature));
  EvaluationFigure expansion;
  expansion.symbol = "NDE";
  expansion.name = "nominal differential expansion of the length";
  expansion.value = found.differential_expansion;
  if (found.differential_uncertainty > 0) expansion.uncertainty = 2 * found.differential_uncertainty;
  report.figures.push_back(std::move(expansion));
  EvaluationFigure uncertainty;
  uncertainty.symbol = "U_L";
  uncertainty.name = "expanded uncertainty of the length by temperature (k = 2)";
  uncertainty.value = 2 * found.combined;
  report.figures.push_back(std::move(uncertainty));
  EvaluationTable table{
      "Contributions to the uncertainty of the length, expanded (k = 2)", {"contribution", "\xC2\xB5m"}, {}};
  nlohmann::ordered_json contributions = nlohmann::ordered_json::array();
  for (const LengthContribution& one : found.contributions) {
    table.rows.push_back({one.name, fmt::format("{:.2f}", 2e3 * one.standard)});
    contributions.push_back({{"name", one.name}, {"expanded_uncertainty_um", 2e3 * one.standard}});
  }
  report.tables.push_back(std::move(table));
  report.details["uncertainty_contributions"] = std::move(contributions);
  report.notes.push_back(
      "U_L is that of a length that has been corrected for NDE; without the correction NDE is a systematic error.");
}

void add_sensor_details(const EtveEvaluation& evaluation, EvaluationReport& report) {
  EvaluationTable table{"Sensors", {"sensor", "readings", "lowest", "highest", "range"}, {}};
  nlohmann::ordered_json sensors = nlohmann::ordered_json::array();
  for (const EtveSensor& one : evaluation.sensors) {
    const TimeSeries& series = one.sensor.series;
    const bool is_angle = one.sensor.is_angle;
    const std::string unit = is_angle ? "_urad" : "_um";
    table.rows.push_back({series.name, std::to_string(series.time.size()), thermal_value_words(one.range.low, is_angle),
                          thermal_value_words(one.range.high, is_angle),
                          thermal_value_words(one.range.value(), is_angle)});
    sensors.push_back({{"name", series.name},
                       {"readings", series.time.size()},
                       {"lowest" + unit, micro_factor(is_angle) * one.range.low},
                       {"lowest_at_s", one.range.low_at},
                       {"highest" + unit, micro_factor(is_angle) * one.range.high},
                       {"highest_at_s", one.range.high_at}});
  }
  nlohmann::ordered_json temperatures = nlohmann::ordered_json::array();
  for (const EtveTemperature& one : evaluation.temperatures) {
    const auto shown = [](double value) { return fmt::format("{:.2f} \xC2\xB0\x43", value); };
    table.rows.push_back({one.series.name, std::to_string(one.series.time.size()), shown(one.range.low),
                          shown(one.range.high), fmt::format("{:.2f} K", one.range.value())});
    temperatures.push_back({{"name", one.series.name},
                            {"readings", one.series.time.size()},
                            {"lowest_degC", one.range.low},
                            {"lowest_at_s", one.range.low_at},
                            {"highest_degC", one.range.high},
                            {"highest_at_s", one.range.high_at},
                            {"mean_degC", one.mean}});
  }
  report.tables.push_back(std::move(table));
  report.details["sensors"] = std::move(sensors);
  report.details["temperatures"] = std::move(temperatures);
}

void add_plots(const EtveEvaluation& evaluation, EvaluationReport& report) {
  const ShownTime time = shown_time(evaluation.from, evaluation.to);
  const std::string time_label = fmt::format("time in {}", time.name);
  std::vector<ThermalCurve> displacements, angles, temperatures;
  for (const EtveSensor& one : evaluation.sensors) {
    const TimeSeries& series = one.sensor.series;
    (one.sensor.is_angle ? angles : displacements)
        .push_back({&series, series.values.front(), micro_factor(one.sensor.is_angle), series.name});
  }
  for (const EtveTemperature& one : evaluation.temperatures)
    temperatures.push_back({&one.series, 0, 1, one.series.name});
  const auto add = [&](const char* name, const std::vector<ThermalCurve>& curves, const char* title,
                       const char* value) {
    if (curves.empty()) return;
    report.plots.push_back({name, "", thermal_plot(curves, time, {title, time_label, value}).picture()});
  };
  add(displacements.empty() ? "displacements" : "plot", displacements,
      "Displacements while only the environment changes", "displacement from the first reading in \xC2\xB5m");
  add(displacements.empty() ? "plot" : "angles", angles, "Angles while only the environment changes",
      "angle from the first reading in \xC2\xB5rad");
  add("temperatures", temperatures, "Temperatures", "temperature in \xC2\xB0\x43");
}

}  // namespace

EvaluationReport etve_report(const std::string& file, const EtveEvaluation& evaluation, bool lacks_distance) {
  EvaluationReport report;
  report.kind = "etve";
  report.title = "Environmental temperature variation error of " + file;
  report.standard = "ISO 230-3:2020";
  report.facts = {{"duration", duration_words(evaluation.duration())},
                  {"displacements and angles", std::to_string(evaluation.sensors.size())},
                  {"temperatures", std::to_string(evaluation.temperatures.size())}};
  report.details = nlohmann::ordered_json::object();
  report.details["duration_s"] = evaluation.duration();
  bool is_stated = false;
  std::vector<const TimeSeries*> all;
  for (const EtveSensor& one : evaluation.sensors) {
    const std::string& name = one.sensor.series.name;
    report.figures.push_back(
        thermal_figure("ETVE_" + name, "ETVE of " + name + " over the test", one.etve, one.sensor.is_angle, name));
    is_stated = is_stated || one.sensor.reading_uncertainty > 0;
    all.push_back(&one.sensor.series);
  }
  for (const EtveSensor& one : evaluation.sensors) {
    const std::string& name = one.sensor.series.name;
    report.figures.push_back(thermal_figure("ETVE1h_" + name, "largest ETVE of " + name + " within an hour", one.hourly,
                                            one.sensor.is_angle, name));
  }
  for (const EtveTemperature& one : evaluation.temperatures) {
    const std::string& name = one.series.name;
    report.figures.push_back(temperature_figure("T_" + name, "temperature range of " + name, one.variation, name));
    report.figures.push_back(
        rate_figure("rate_" + name, "largest temperature change of " + name + " within an hour", one.rate, name));
    all.push_back(&one.series);
  }
  add_thermal_notes(is_stated, lacks_distance, all, report);
  if (evaluation.length && evaluation.length_of) add_length(*evaluation.length_of, *evaluation.length, report);
  add_sensor_details(evaluation, report);
  if (evaluation.temperatures.empty()) {
    report.notes.push_back(
        "There is no temperature (NAME_degC): an ETVE holds for temperatures that change as they did in the test.");
  }
  add_plots(evaluation, report);
  return report;
}

}  // namespace abbe
