#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/machine/axis_unit.h"
#include "abbe/report/drawings/thermal_plot.h"
#include "abbe/report/evaluations/thermal_figures.h"
#include "abbe/report/evaluations/thermal_report.h"

namespace abbe {
namespace {

/// What a sensor at a target is called: "P1", "P1+", and "P1_B" of an angle B.
std::string sensor_symbol(const AxisTarget& target, const AxisTargetSensor& sensor) {
  const std::string symbol = axis_target_name(target.number, target.approach);
  return sensor.is_deviation ? symbol : symbol + "_" + sensor.sensor.series.name;
}

std::string direction_words(const std::string& approach) {
  return approach.empty() ? "" : fmt::format(", direction {}", approach);
}

void add_axis_figures(const AxisDistortion& distortion, EvaluationReport& report) {
  for (const AxisTarget& target : distortion.targets) {
    for (const AxisTargetSensor& one : target.sensors) {
      const std::string what = one.is_deviation ? "positioning deviation" : one.sensor.series.name;
      report.figures.push_back(thermal_figure(
          "d_" + sensor_symbol(target, one),
          fmt::format("range of {} at {:.6g} mm{}", what, target.target, direction_words(target.approach)), one.change,
          one.sensor.is_angle, sensor_symbol(target, one)));
    }
  }
  for (const AxisExpansion& one : distortion.expansions) {
    const std::string direction = direction_words(one.approach);
    report.figures.push_back(
        thermal_figure("d_L" + one.approach,
                       fmt::format("range of the distance of the outer targets, {:.6g} mm{}", one.length, direction),
                       one.range, false, "L" + one.approach));
    EvaluationFigure expansion;
    expansion.symbol = "expansion_L" + one.approach;
    expansion.name = "expansion of the scale over the test" + direction;
    expansion.quantity = Quantity::length_per_length;
    expansion.unit = "um_per_m";
    expansion.value = one.expansion;
    if (one.expansion_uncertainty > 0) expansion.uncertainty = 2 * one.expansion_uncertainty;
    expansion.about = {"L" + one.approach};
    report.figures.push_back(std::move(expansion));
    report.figures.push_back(time_constant_figure("tau_L" + one.approach, "time constant of the distance" + direction,
                                                  one.response, "L" + one.approach));
  }
}

void add_axis_targets(const AxisDistortion& distortion, EvaluationReport& report) {
  EvaluationTable table{"Targets; changes are from the first reading to the last",
                        {"sensor", "target", "readings", "range", "change"},
                        {}};
  nlohmann::ordered_json targets = nlohmann::ordered_json::array();
  for (const AxisTarget& target : distortion.targets) {
    nlohmann::ordered_json entry = {{"name", axis_target_name(target.number, target.approach)},
                                    {"target_mm", target.target}};
    if (!target.approach.empty()) entry["direction"] = target.approach;
    for (const AxisTargetSensor& one : target.sensors) {
      const bool is_angle = one.sensor.is_angle;
      const std::string unit = is_angle ? "_urad" : "_um";
      const double micro = micro_per_unit(is_angle);
      table.rows.push_back({sensor_symbol(target, one), fmt::format("{:.6g} mm", target.target),
                            std::to_string(one.sensor.series.time.size()), change_words(one.change.value, is_angle),
                            change_words(one.change_at_end, is_angle)});
      entry["sensors"].push_back({{"name", one.sensor.series.name},
                                  {"readings", one.sensor.series.time.size()},
                                  {"range" + unit, micro * one.change.value},
                                  {"change" + unit, micro * one.change_at_end}});
    }
    targets.push_back(std::move(entry));
  }
  report.tables.push_back(std::move(table));
  report.details["targets"] = std::move(targets);
  nlohmann::ordered_json distances = nlohmann::ordered_json::array();
  for (const AxisExpansion& one : distortion.expansions) {
    nlohmann::ordered_json entry = {{"length_mm", one.length},
                                    {"from_s", one.distance.from()},
                                    {"to_s", one.distance.to()},
                                    {"change_um", 1e3 * one.distance.values.back()},
                                    {"response", response_json(one.response, false)}};
    if (!one.approach.empty()) entry["direction"] = one.approach;
    distances.push_back(std::move(entry));
  }
  report.details["distances"] = std::move(distances);
}

void add_axis_plots(const AxisDistortion& distortion, EvaluationReport& report) {
  std::vector<ThermalCurve> deviations, across, angles, temperatures;
  for (const AxisTarget& target : distortion.targets) {
    for (const AxisTargetSensor& one : target.sensors) {
      const TimeSeries& series = one.sensor.series;
      auto& curves = one.is_deviation ? deviations : one.sensor.is_angle ? angles : across;
      curves.push_back(
          {&series, series.values.front(), micro_per_unit(one.sensor.is_angle), sensor_symbol(target, one)});
    }
  }
  for (const AxisExpansion& one : distortion.expansions) {
    deviations.push_back({&one.distance, 0, 1e3, "L" + one.approach, {one.response}});
  }
  for (const TimeSeries& series : distortion.temperatures) temperatures.push_back({&series, 0, 1, series.name});
  const ShownTime time = shown_time(distortion.from, distortion.to);
  const auto add = [&](const char* name, const std::vector<ThermalCurve>& curves, const char* title,
                       const char* value) {
    if (curves.empty()) return;
    const ThermalPlotWords words = {title, fmt::format("time in {}", time.name), value, "first-order response", ""};
    report.plots.push_back({name, "", thermal_plot(curves, time, words).picture()});
  };
  add("plot", deviations, "Distortion by the moving axis", "change from the first reading in \xC2\xB5m");
  add("across", across, "Displacements across the axis", "change from the first reading in \xC2\xB5m");
  add("angles", angles, "Angles at the targets", "change from the first reading in \xC2\xB5rad");
  add("temperatures", temperatures, "Temperatures", "temperature in \xC2\xB0\x43");
}

}  // namespace

std::string axis_target_name(std::size_t number, const std::string& approach) {
  return fmt::format("P{}{}", number, approach);
}

EvaluationReport axis_distortion_report(const std::string& file, const AxisDistortion& distortion) {
  EvaluationReport report;
  report.kind = "axis-distortion";
  report.title = "Thermal distortion by the moving axis: " + file;
  report.standard = "ISO 230-3:2020";
  report.facts = {{"duration", duration_words(distortion.to - distortion.from)},
                  {"targets", fmt::format("{} from {:.6g} to {:.6g} mm", distortion.targets.back().number,
                                          distortion.targets.front().target, distortion.targets.back().target)}};
  report.details = nlohmann::ordered_json::object();
  report.details["duration_s"] = distortion.to - distortion.from;
  add_axis_figures(distortion, report);
  bool is_stated = false;
  std::vector<const TimeSeries*> all;
  for (const AxisTarget& target : distortion.targets) {
    for (const AxisTargetSensor& one : target.sensors) {
      is_stated = is_stated || one.sensor.reading_uncertainty > 0;
      all.push_back(&one.sensor.series);
    }
  }
  add_thermal_notes(is_stated, false, all, report);
  if (distortion.expansions.empty()) {
    report.notes.push_back(
        "The targets were not read over a common time: neither the change of their distance nor an expansion is "
        "known.");
  }
  add_axis_targets(distortion, report);
  add_axis_plots(distortion, report);
  return report;
}

}  // namespace abbe
