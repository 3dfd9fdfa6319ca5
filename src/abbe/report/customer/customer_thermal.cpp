#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "abbe/report/customer/customer_parts.h"
#include "abbe/report/customer/customer_tests.h"
#include "abbe/report/customer/local_numbers.h"
#include "abbe/report/drawings/thermal_plot.h"
#include "abbe/report/evaluations/thermal_report.h"

namespace abbe {
namespace {

using Word = CustomerWord;

/// More columns do not fit on a sheet.
constexpr std::size_t kMostSensorsInTable = 6;

/// A line of a drawing and a column of a table.
struct ShownSensor {
  ThermalCurve curve;
  bool is_angle = false;
  std::string unit() const { return is_angle ? "µrad" : "µm"; }
};

ShownSensor shown_sensor(const TimeSeries& series, double origin, bool is_angle, const std::string& name,
                         std::vector<FirstOrderResponse> responses = {}) {
  return {{&series, origin, is_angle ? 1e6 : 1e3, name, std::move(responses)}, is_angle};
}

/// A line at a time of a drawing, and what it says.
struct ShownMark {
  std::optional<double> time{};
  Word words = Word::stop;
};

/// Drawings of displacements and of angles, and a table of both.
void add_sensors(const std::vector<ShownSensor>& sensors, const ShownTime& time, const ShownMark& mark,
                 CustomerReport& report) {
  const ReportLanguage language = report.facts.language;
  for (const bool is_angle : {false, true}) {
    std::vector<ThermalCurve> curves;
    for (const ShownSensor& sensor : sensors) {
      if (sensor.is_angle == is_angle) curves.push_back(sensor.curve);
    }
    if (curves.empty()) continue;
    const Word value = is_angle ? Word::angle : Word::displacement;
    const ThermalPlotWords words = {report.subject, local_word_with_unit(Word::time, time.name, language),
                                    local_word_with_unit(value, is_angle ? "µrad" : "µm", language),
                                    local_word(Word::first_order, language), local_word(mark.words, language)};
    report.drawings.push_back(
        {local_word(value, language), thermal_plot(curves, time, words, mark.time).picture().wide});
  }
  for (std::size_t first = 0; first < sensors.size(); first += kMostSensorsInTable) {
    const std::size_t last = std::min(sensors.size(), first + kMostSensorsInTable);
    CustomerTable table;
    table.caption = local_word(Word::changes_over_time, language);
    table.headers = {local_word_with_unit(Word::time, time.name, language)};
    for (std::size_t i = first; i < last; ++i) {
      table.headers.push_back(sensors[i].curve.name + " / " + sensors[i].unit());
    }
    for (const double at : sensors[first].curve.series->time) {
      std::vector<std::string> row = {local_number(time.number(at), 2, language)};
      for (std::size_t i = first; i < last; ++i) {
        const ThermalCurve& curve = sensors[i].curve;
        const bool is_read = at >= curve.series->from() && at <= curve.series->to();
        row.push_back(is_read ? local_number((value_at(*curve.series, at) - curve.origin) * curve.factor, 2, language)
                              : std::string(kNothingShown));
      }
      table.rows.push_back(std::move(row));
    }
    thin_table_rows(sensors.size() > kMostSensorsInTable ? kMostRowsOfTwoTables : kMostTableRows, table);
    report.tables.push_back(std::move(table));
  }
}

void add_warming(const std::vector<WarmingSensor>& sensors, const WarmingRun& run, Word stop, CustomerReport& report) {
  std::vector<ShownSensor> shown;
  for (const WarmingSensor& one : sensors) {
    const TimeSeries& series = one.sensor.series;
    shown.push_back(
        shown_sensor(series, one.value_at_start, one.sensor.is_angle, series.name, {one.warming, one.recovery}));
  }
  ShownMark mark{.words = stop};
  if (run.has_cooling()) mark.time = run.stop;
  add_sensors(shown, shown_time(run.start, run.end), mark, report);
}

}  // namespace

CustomerReport customer_etve(const ReportFacts& facts, const EvaluationReport& now, const EtveEvaluation& evaluation,
                             const EvaluationReport* before) {
  CustomerReport report = begun_test_report(facts, now, before, Word::etve_test);
  add_fact(now, "duration", Word::duration_fact, report);
  std::vector<ShownSensor> sensors;
  for (const EtveSensor& one : evaluation.sensors) {
    const TimeSeries& series = one.sensor.series;
    sensors.push_back(shown_sensor(series, series.values.front(), one.sensor.is_angle, series.name));
  }
  add_sensors(sensors, shown_time(evaluation.from, evaluation.to), {}, report);
  return report;
}

CustomerReport customer_spindle_distortion(const ReportFacts& facts, const EvaluationReport& now,
                                           const SpindleDistortion& distortion, const EvaluationReport* before) {
  CustomerReport report = begun_test_report(facts, now, before, Word::spindle_distortion_test);
  add_fact(now, "rotation", Word::rotation_fact, report);
  add_fact(now, "cooling", Word::cooling_fact, report);
  add_warming(distortion.sensors, distortion.run, Word::stop, report);
  return report;
}

CustomerReport customer_location_distortion(const ReportFacts& facts, const EvaluationReport& now,
                                            const LocationDistortion& distortion, const EvaluationReport* before) {
  CustomerReport report = begun_test_report(facts, now, before, Word::location_distortion_test);
  add_fact(now, "heating", Word::heating_fact, report);
  add_fact(now, "cooling", Word::cooling_fact, report);
  add_fact(now, "cycles", Word::cycles_fact, report);
  add_warming(distortion.locations, distortion.run, Word::heating_stop, report);
  return report;
}

CustomerReport customer_axis_distortion(const ReportFacts& facts, const EvaluationReport& now,
                                        const AxisDistortion& distortion, const EvaluationReport* before) {
  CustomerReport report = begun_test_report(facts, now, before, Word::axis_distortion_test);
  add_fact(now, "duration", Word::duration_fact, report);
  std::string targets;
  std::vector<ShownSensor> sensors;
  for (const AxisTarget& target : distortion.targets) {
    const std::string name = axis_target_name(target.number, target.approach);
    targets += (targets.empty() ? "" : ", ") + name + " = " + local_short_number(target.target, facts.language) + " mm";
    for (const AxisTargetSensor& one : target.sensors) {
      const TimeSeries& series = one.sensor.series;
      sensors.push_back(shown_sensor(series, series.values.front(), one.sensor.is_angle,
                                     one.is_deviation ? name : name + " " + series.name));
    }
  }
  report.conditions.push_back(customer_text(Word::targets_fact, facts.language, targets));
  for (const AxisExpansion& one : distortion.expansions) {
    sensors.push_back(shown_sensor(one.distance, 0, false, "L" + one.approach, {one.response}));
  }
  add_sensors(sensors, shown_time(distortion.from, distortion.to), {}, report);
  return report;
}

}  // namespace abbe
