#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/report/drawings/thermal_plot.h"
#include "abbe/report/evaluations/thermal_figures.h"
#include "abbe/report/evaluations/thermal_report.h"

namespace abbe {
namespace {

void add_spindle_figures(const SpindleSensor& one, bool has_cooling, EvaluationReport& report) {
  const std::string& name = one.sensor.series.name;
  const bool is_angle = one.sensor.is_angle;
  const auto add = [&](const char* symbol, const std::string& words, const ThermalFigure& figure) {
    report.figures.push_back(thermal_figure(symbol + name, words, figure, is_angle, name));
  };
  add("d60_", "range of " + name + " in the first 60 min of rotation", one.first_hour);
  add("d_", "range of " + name + " over the time of rotation", one.running);
  if (has_cooling) add("dcool_", "range of " + name + " after the stop", one.cooling);
  report.figures.push_back(
      time_constant_figure("tau_" + name, "time constant of " + name + " while warming", one.warming, name));
}

std::string constant_words(const FirstOrderResponse& response) {
  if (response.status == ResponseStatus::not_run) return "-";
  if (response.status != ResponseStatus::done) return response_words(response.status);
  return fmt::format("{:.1f} \xC2\xB1 {:.1f} min", response.time_constant / 60, 2 * response.uncertainty / 60);
}

void add_spindle_sensors(const SpindleDistortion& distortion, EvaluationReport& report) {
  EvaluationTable table{"Changes from the start of rotation; time constants with their expanded uncertainty (k = 2)",
                        {"sensor", "at the stop", "at the end", "warming", "cooling"},
                        {}};
  nlohmann::ordered_json sensors = nlohmann::ordered_json::array();
  for (const SpindleSensor& one : distortion.sensors) {
    const bool is_angle = one.sensor.is_angle;
    const std::string unit = is_angle ? "_urad" : "_um";
    const double micro = micro_factor(is_angle);
    table.rows.push_back({one.sensor.series.name, thermal_value_words(one.change_at_stop, is_angle),
                          thermal_value_words(one.change_at_end, is_angle), constant_words(one.warming),
                          constant_words(one.recovery)});
    nlohmann::ordered_json entry = {{"name", one.sensor.series.name},
                                    {"readings", one.sensor.series.time.size()},
                                    {"value_at_start" + unit, micro * one.value_at_start},
                                    {"change_at_stop" + unit, micro * one.change_at_stop},
                                    {"change_at_end" + unit, micro * one.change_at_end},
                                    {"warming", response_json(one.warming, is_angle)}};
    if (one.recovery.status != ResponseStatus::not_run) entry["cooling"] = response_json(one.recovery, is_angle);
    sensors.push_back(std::move(entry));
  }
  report.tables.push_back(std::move(table));
  report.details["sensors"] = std::move(sensors);
}

void add_spindle_plots(const SpindleDistortion& distortion, EvaluationReport& report) {
  double from = distortion.run.start, to = distortion.run.end;
  std::vector<ThermalCurve> displacements, angles, temperatures;
  for (const SpindleSensor& one : distortion.sensors) {
    const TimeSeries& series = one.sensor.series;
    (one.sensor.is_angle ? angles : displacements)
        .push_back(
            {&series, one.value_at_start, micro_factor(one.sensor.is_angle), series.name, {one.warming, one.recovery}});
  }
  for (const TimeSeries& series : distortion.temperatures) temperatures.push_back({&series, 0, 1, series.name});
  const ShownTime time = shown_time(from, to);
  std::optional<double> mark;
  if (distortion.run.has_cooling()) mark = distortion.run.stop;
  const auto add = [&](const char* name, const std::vector<ThermalCurve>& curves, const char* title,
                       const char* value) {
    if (curves.empty()) return;
    const ThermalPlotWords words = {title, fmt::format("time since the start in {}", time.name), value,
                                    "first-order response", "stop"};
    report.plots.push_back({name, "", thermal_plot(curves, time, words, mark).picture()});
  };
  add("plot", displacements.empty() ? angles : displacements, "Distortion by the rotating spindle",
      displacements.empty() ? "angle from the start in \xC2\xB5rad" : "displacement from the start in \xC2\xB5m");
  if (!displacements.empty()) {
    add("angles", angles, "Tilt by the rotating spindle", "angle from the start in \xC2\xB5rad");
  }
  add("temperatures", temperatures, "Temperatures", "temperature in \xC2\xB0\x43");
}

}  // namespace

EvaluationReport spindle_distortion_report(const std::string& file, const SpindleDistortion& distortion,
                                           bool lacks_distance) {
  EvaluationReport report;
  report.kind = "spindle-distortion";
  report.title = "Thermal distortion by the rotating spindle: " + file;
  report.standard = "ISO 230-3:2020";
  const SpindleRun& run = distortion.run;
  report.facts = {{"rotation", duration_words(run.stop - run.start)}};
  if (run.has_cooling()) report.facts.emplace_back("cooling", duration_words(run.end - run.stop));
  report.facts.emplace_back("displacements and angles", std::to_string(distortion.sensors.size()));
  report.details = nlohmann::ordered_json::object();
  report.details["rotation_s"] = run.stop - run.start;
  report.details["cooling_s"] = run.end - run.stop;
  bool is_stated = false;
  std::vector<const TimeSeries*> all;
  for (const SpindleSensor& one : distortion.sensors) {
    add_spindle_figures(one, run.has_cooling(), report);
    is_stated = is_stated || one.sensor.reading_uncertainty > 0;
    all.push_back(&one.sensor.series);
  }
  add_thermal_notes(is_stated, lacks_distance, all, report);
  report.notes.push_back(
      "Uncertainties of time constants are those of the fit, from its residuals or from the stated uncertainty of a "
      "reading, whichever is larger.");
  add_spindle_sensors(distortion, report);
  add_spindle_plots(distortion, report);
  return report;
}

}  // namespace abbe
