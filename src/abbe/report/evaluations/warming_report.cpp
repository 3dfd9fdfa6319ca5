#include "abbe/report/evaluations/warming_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "abbe/machine/axis_unit.h"
#include "abbe/report/drawings/thermal_plot.h"
#include "abbe/report/evaluations/thermal_figures.h"

namespace abbe {
namespace {

std::string constant_words(const FirstOrderResponse& response) {
  if (response.status == ResponseStatus::not_run) return "-";
  if (response.status != ResponseStatus::done) return response_words(response.status);
  return fmt::format("{:.1f} \xC2\xB1 {:.1f} min", response.time_constant / 60, 2 * response.uncertainty / 60);
}

}  // namespace

EvaluationReport begun_warming_report(const char* kind, const std::string& title, const WarmingWords& words,
                                      const WarmingRun& run) {
  EvaluationReport report;
  report.kind = kind;
  report.title = title;
  report.standard = "ISO 230-3:2020";
  report.facts = {{words.during, duration_words(run.stop - run.start)}};
  if (run.has_cooling()) report.facts.emplace_back("cooling", duration_words(run.end - run.stop));
  report.details = nlohmann::ordered_json::object();
  report.details[fmt::format("{}_s", words.during)] = run.stop - run.start;
  report.details["cooling_s"] = run.end - run.stop;
  return report;
}

void add_warming_figures(const WarmingSensor& one, bool has_cooling, const WarmingWords& words,
                         EvaluationReport& report) {
  const std::string& name = one.sensor.series.name;
  const bool is_angle = one.sensor.is_angle;
  const auto add = [&](const char* symbol, const std::string& name_of_figure, const ThermalFigure& figure) {
    report.figures.push_back(thermal_figure(symbol + name, name_of_figure, figure, is_angle, name));
  };
  add("d60_", "range of " + name + " in the first 60 min of " + words.during, one.first_hour);
  add("d_", "range of " + name + " over the time of " + words.during, one.running);
  if (has_cooling) add("dcool_", "range of " + name + " after the stop", one.cooling);
  report.figures.push_back(
      time_constant_figure("tau_" + name, "time constant of " + name + " while warming", one.warming, name));
}

void add_warming_sensors(const std::vector<WarmingSensor>& sensors, const WarmingWords& words, const char* key,
                         EvaluationReport& report) {
  EvaluationTable table{
      fmt::format("Changes from the start of {}; time constants with their expanded uncertainty (k = 2)", words.during),
      {words.what, "at the stop", "at the end", "warming", "cooling"},
      {}};
  nlohmann::ordered_json entries = nlohmann::ordered_json::array();
  for (const WarmingSensor& one : sensors) {
    const bool is_angle = one.sensor.is_angle;
    const std::string unit = is_angle ? "_urad" : "_um";
    const double micro = micro_per_unit(is_angle);
    table.rows.push_back({one.sensor.series.name, change_words(one.change_at_stop, is_angle),
                          change_words(one.change_at_end, is_angle), constant_words(one.warming),
                          constant_words(one.recovery)});
    nlohmann::ordered_json entry = {{"name", one.sensor.series.name},
                                    {"readings", one.sensor.series.time.size()},
                                    {"value_at_start" + unit, micro * one.value_at_start},
                                    {"change_at_stop" + unit, micro * one.change_at_stop},
                                    {"change_at_end" + unit, micro * one.change_at_end},
                                    {"warming", response_json(one.warming, is_angle)}};
    if (one.recovery.status != ResponseStatus::not_run) entry["cooling"] = response_json(one.recovery, is_angle);
    entries.push_back(std::move(entry));
  }
  report.tables.push_back(std::move(table));
  report.details[key] = std::move(entries);
}

void add_warming_plots(const WarmingRun& run, const std::vector<WarmingSensor>& sensors,
                       const std::vector<TimeSeries>& temperatures, const WarmingWords& words,
                       EvaluationReport& report) {
  std::vector<ThermalCurve> displacements, angles, read;
  for (const WarmingSensor& one : sensors) {
    const TimeSeries& series = one.sensor.series;
    (one.sensor.is_angle ? angles : displacements)
        .push_back({&series,
                    one.value_at_start,
                    micro_per_unit(one.sensor.is_angle),
                    series.name,
                    {one.warming, one.recovery}});
  }
  for (const TimeSeries& series : temperatures) read.push_back({&series, 0, 1, series.name});
  const ShownTime time = shown_time(run.start, run.end);
  std::optional<double> mark;
  if (run.has_cooling()) mark = run.stop;
  const auto add = [&](const char* name, const std::vector<ThermalCurve>& curves, const std::string& title,
                       const char* value) {
    if (curves.empty()) return;
    const ThermalPlotWords plot_words = {title, fmt::format("time since the start in {}", time.name), value,
                                         "first-order response", "stop"};
    report.plots.push_back({name, "", thermal_plot(curves, time, plot_words, mark).picture()});
  };
  add("plot", displacements.empty() ? angles : displacements, fmt::format("{} {}", words.displaced, words.by),
      displacements.empty() ? "angle from the start in \xC2\xB5rad" : "displacement from the start in \xC2\xB5m");
  if (!displacements.empty()) {
    add("angles", angles, fmt::format("{} {}", words.turned, words.by), "angle from the start in \xC2\xB5rad");
  }
  add("temperatures", read, "Temperatures", "temperature in \xC2\xB0\x43");
}

}  // namespace abbe
