#include "abbe/controls/kinematic_values_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/controls/carried_text.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/machine/position_words.h"
#include "abbe/report/evaluations/position_json.h"
#include "abbe/report/evaluations/statistics_json.h"
#include "abbe/report/words/state_words.h"
#include "abbe/report/words/volumetric_words.h"

namespace abbe {
namespace {

std::string value_line(const KinematicValue& value) {
  const bool length = value.kind == ValueKind::length;
  const double unit = value.kind == ValueKind::angle ? kDegree : 1;
  const char* const suffix = length ? " mm" : value.kind == ValueKind::angle ? " deg" : "";
  const int places = length ? 4 : 7;
  const double micro = micro_per_unit(!length);
  std::string text =
      fmt::format("  {:<32} {:>14.{}f} -> {:>14.{}f}{}, {:+.2f} {}", value.name, value.nominal / unit, places,
                  value.actual / unit, places, suffix, micro * (value.actual - value.nominal), micro_unit(!length));
  if (value.standard_uncertainty) {
    text += fmt::format(" (standard uncertainty {:.2f})", micro * *value.standard_uncertainty);
  }
  return text + "\n";
}

nlohmann::ordered_json value_json(const KinematicValue& value) {
  nlohmann::ordered_json one;
  one["name"] = value.name;
  const bool length = value.kind == ValueKind::length;
  const double unit = value.kind == ValueKind::angle ? kDegree : 1;
  const std::string suffix = length ? "_mm" : value.kind == ValueKind::angle ? "_deg" : "";
  one["nominal" + suffix] = value.nominal / unit;
  one["actual" + suffix] = value.actual / unit;
  if (value.standard_uncertainty) {
    one[std::string("standard_uncertainty_") + micro_unit(!length)] =
        micro_per_unit(!length) * *value.standard_uncertainty;
  }
  return one;
}

}  // namespace

std::string kinematic_values_text(const KinematicValuesReport& report) {
  const KinematicValues& made = report.made;
  std::string text =
      fmt::format("kinematic values of {} for {}: {}\n", report.machine.name, made.format.name, made.format.what);
  text += fmt::format("convention: {}\n", made.format.convention);
  if (!made.format.unverified.empty()) text += fmt::format("EXPERIMENTAL, not verified: {}\n", made.format.unverified);
  text += state_line(report.partial.at_state);
  if (!made.state_pose.empty()) {
    text += fmt::format("states that follow from the commands are taken at {}\n",
                        position_words(report.machine, made.state_pose));
  }
  text += "values, nominal and with the location errors:\n";
  for (const KinematicValue& value : made.values) text += value_line(value);
  text +=
      "each error by itself, with nominal values and with its values (shift of the functional point, rms over the "
      "grid):\n";
  text += carried_errors_lines(made.errors);
  text += fmt::format("  limits of the format: {}\n", made.format.cannot);
  text += volumetric_text(made.volumetric);
  text += error_line("what these values leave of it", made.left_by_values);
  text += fmt::format("displacement of the tool at {} poses, datum unchanged, worse direction of approach:\n",
                      made.poses.count());
  text += deviations_line("nominal values", made.before);
  text += deviations_line("with these values", made.after);
  if (!made.state_pose.empty()) {
    text += deviations_line("the same, states as at that pose everywhere", made.after_at_state_pose);
  }
  text += deviations_line("ideal compensation", made.ideal);
  if (made.ideal_not_reached > 0) {
    text += fmt::format("  (ideal: the point is not reached at {} poses)\n", made.ideal_not_reached);
  }
  if (report.partial.is_partial()) text += fmt::format("caution: {}\n", report.partial.caution());
  for (const std::string& words : made.settings) text += fmt::format("setting: {}\n", words);
  for (const std::string& name : report.written) text += fmt::format("{} written\n", name);
  return text;
}

nlohmann::ordered_json kinematic_values_json(const KinematicValuesReport& report) {
  const KinematicValues& made = report.made;
  nlohmann::ordered_json json;
  json["machine"] = report.machine.name;
  json["format"] = made.format.name;
  json["convention"] = made.format.convention;
  json["unverified"] = made.format.unverified;
  json["values"] = nlohmann::ordered_json::array();
  for (const KinematicValue& value : made.values) json["values"].push_back(value_json(value));
  json["refused"] = made.refused;
  json["errors"] = nlohmann::ordered_json::array();
  for (const CarriedError& error : made.errors) json["errors"].push_back(carried_error_json(error));
  json["why_not"] = made.format.cannot;
  json["poses"] = made.poses.count();
  add_volumetric_figures(made.volumetric, json);
  json["volumetric_error_left_by_values_um"] = statistics_um(made.left_by_values);
  json["before"] = deviations_json(made.before);
  json["after"] = deviations_json(made.after);
  if (!made.state_pose.empty()) {
    json["state_pose"] = position_json(report.machine, made.state_pose);
    json["after_at_state_pose"] = deviations_json(made.after_at_state_pose);
  }
  json["ideal"] = deviations_json(made.ideal);
  json["ideal_not_reached"] = made.ideal_not_reached;
  add_partial_errors(report.partial, json);
  json["settings"] = made.settings;
  json["files"] = report.written;
  return json;
}

}  // namespace abbe
