#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/formats/files/file_name.h"
#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/list_text.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/report/pages/measuring_sheet.h"
#include "abbe/study/planning/planned_measurement.h"

namespace abbe {
namespace {

/// Where an axis goes, poses on the way included; mm or rad.
std::pair<double, double> used_travel(const PlannedMeasurement& planned, std::size_t axis) {
  double least = planned.readings.front().pose[axis], most = least;
  const auto take = [&](const std::vector<double>& pose) {
    least = std::min(least, pose[axis]);
    most = std::max(most, pose[axis]);
  };
  for (const PlannedReading& reading : planned.readings) {
    for (const std::vector<double>& pose : reading.via) take(pose);
    take(reading.pose);
  }
  return {least, most};
}

/// "1:05:09", "5:09": hours only where there are any.
std::string duration_text(double seconds) {
  const auto whole = static_cast<long long>(seconds + 0.5);
  const long long hours = whole / 3600, minutes = whole / 60 % 60;
  return hours > 0 ? fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60)
                   : fmt::format("{}:{:02}", minutes, whole % 60);
}

std::string travel_text(const Axis& axis) {
  if (axis.endless) return "endless";
  const double unit = position_unit(axis);
  return fmt::format("{:g} to {:g}", axis.travel_min / unit, axis.travel_max / unit);
}

/// Whether any reading says something in a field.
bool is_stated(const PlannedMeasurement& planned, std::string ListedReading::*field) {
  return std::any_of(planned.readings.begin(), planned.readings.end(),
                     [field](const PlannedReading& reading) { return !(reading.listed.*field).empty(); });
}

MeasuringSheetTable travel_table(const PlannedMeasurement& planned) {
  MeasuringSheetTable table{"Travel used", {"axis", "from", "to", "unit", "travel of the axis"}, {}, {}};
  for (std::size_t i = 0; i < planned.machine.axes.size(); ++i) {
    const Axis& axis = planned.machine.axes[i];
    const double unit = position_unit(axis);
    const auto [least, most] = used_travel(planned, i);
    table.rows.push_back({axis.name, fmt::format("{:.3f}", least / unit), fmt::format("{:.3f}", most / unit),
                          position_suffix(axis), travel_text(axis)});
  }
  return table;
}

MeasuringSheetTable readings_table(const PlannedMeasurement& planned, const PlannedSection& section) {
  MeasuringSheetTable table;
  const bool has_point = is_stated(planned, &ListedReading::point), has_what = is_stated(planned, &ListedReading::what);
  // A section without a name of its own may mix set-ups and stations.
  const bool has_setup = section.setup.empty() && is_stated(planned, &ListedReading::setup);
  const bool has_station = section.station.empty() && is_stated(planned, &ListedReading::station);
  table.caption = fmt::format("{}: {}", section.words, counted(section.count, "reading", "readings"));
  table.caption[0] = upper_case(table.caption[0]);
  table.headers = {"no.", "time"};
  for (const Axis& axis : planned.machine.axes) {
    table.headers.push_back(axis.name + (axis.kind == AxisKind::rotary ? " / \xC2\xB0" : " / mm"));
  }
  if (has_setup) table.headers.emplace_back("set-up");
  if (has_station) table.headers.emplace_back("station");
  if (has_point) table.headers.emplace_back("point");
  if (has_what) table.headers.push_back(planned.what);
  table.blank = {"value", "remark"};
  for (std::size_t k = section.first; k < section.first + section.count; ++k) {
    const PlannedReading& reading = planned.readings[k];
    std::vector<std::string>& row = table.rows.emplace_back();
    row = {std::to_string(reading.number), duration_text(reading.finished)};
    for (std::size_t i = 0; i < reading.pose.size(); ++i) {
      row.push_back(fmt::format("{:.3f}", reading.pose[i] / position_unit(planned.machine.axes[i])));
    }
    if (has_setup) row.push_back(reading.listed.setup);
    if (has_station) row.push_back(reading.listed.station);
    if (has_point) row.push_back(reading.listed.point);
    if (has_what) row.push_back(reading.listed.what);
  }
  return table;
}

}  // namespace

std::string planned_measurement_text(const PlannedMeasurement& planned) {
  std::string text = fmt::format("{}: {} of {}\n", planned.machine.name,
                                 counted(planned.readings.size(), "reading", "readings"), planned.readings_file);
  if (planned.sections.size() > 1) {
    for (const PlannedSection& section : planned.sections) {
      text += fmt::format("  {:>6} at {}\n", section.count, section.words);
    }
  }
  for (const std::string& note : planned.notes) text += "note: " + note + "\n";
  if (!planned.refused.empty()) return text;
  text += "axes\n";
  for (std::size_t i = 0; i < planned.machine.axes.size(); ++i) {
    const Axis& axis = planned.machine.axes[i];
    const double unit = position_unit(axis);
    const auto [least, most] = used_travel(planned, i);
    text += fmt::format("  {:<3} {:>12.3f} to {:>12.3f} {:<3}  (travel {})\n", axis.name, least / unit, most / unit,
                        position_suffix(axis), travel_text(axis));
  }
  if (!planned.obstacles.empty()) {
    text += fmt::format("clear of {}: {} straight, {} around\n", first_few(planned.obstacles, ", "),
                        counted(planned.readings.size() - planned.ways_around(), "way", "ways"), planned.ways_around());
  }
  return text +
         fmt::format("time {} without acceleration and without stops for the operator\n", duration_text(planned.time));
}

nlohmann::ordered_json planned_measurement_json(const PlannedMeasurement& planned) {
  nlohmann::ordered_json json;
  json["format"] = "abbe-measuring-program/1";
  json["machine"] = planned.machine.name;
  json["readings_file"] = planned.readings_file;
  json["dialect"] = planned.dialect;
  json["obstacles"] = planned.obstacles;
  json["notes"] = planned.notes;
  if (!planned.refused.empty()) {
    json["refused"] = planned.refused;
    return json;
  }
  json["time_s"] = planned.time;
  json["ways_around"] = planned.ways_around();
  const auto pose_json = [&](const std::vector<double>& pose) {
    nlohmann::ordered_json one;
    for (std::size_t i = 0; i < pose.size(); ++i) {
      const Axis& axis = planned.machine.axes[i];
      one[axis.name + "_" + position_suffix(axis)] = pose[i] / position_unit(axis);
    }
    return one;
  };
  for (const PlannedSection& section : planned.sections) {
    nlohmann::ordered_json one = {{"words", section.words}};
    for (std::size_t k = section.first; k < section.first + section.count; ++k) {
      const PlannedReading& reading = planned.readings[k];
      nlohmann::ordered_json entry = {{"number", reading.number}};
      if (reading.listed.line > 0) entry["line"] = reading.listed.line;
      entry["pose"] = pose_json(reading.pose);
      for (const std::vector<double>& pose : reading.via) entry["via"].push_back(pose_json(pose));
      entry["finished_s"] = reading.finished;
      one["readings"].push_back(std::move(entry));
    }
    json["sections"].push_back(std::move(one));
  }
  return json;
}

std::string planned_measurement_sheet(const PlannedMeasurement& planned) {
  MeasuringSheet sheet;
  sheet.title = "Measuring program: " + file_name(planned.readings_file);
  sheet.subtitle = planned.machine.name;
  sheet.facts = {{"machine", fmt::format("{} ({})", planned.machine.name, planned.machine.chain())},
                 {"date", ""},
                 {"readings", fmt::format("{}, {}", planned.readings.size(),
                                          counted(planned.sections.size(), "section", "sections"))},
                 {"operator", ""},
                 {"program for", planned.dialect},
                 {"temperature", ""},
                 {"time", duration_text(planned.time) + " without stops and acceleration"},
                 {"instrument", ""}};
  if (!planned.obstacles.empty()) {
    sheet.facts.emplace_back("clear of", fmt::format("{}; {} around", first_few(planned.obstacles, ", "),
                                                     counted(planned.ways_around(), "way", "ways")));
  }
  sheet.notes = planned.notes;
  for (std::string& note : sheet.notes) {
    note[0] = upper_case(note[0]);
    note += ".";
  }
  sheet.tables.push_back(travel_table(planned));
  for (const PlannedSection& section : planned.sections) sheet.tables.push_back(readings_table(planned, section));
  return measuring_sheet_page(sheet);
}

}  // namespace abbe
