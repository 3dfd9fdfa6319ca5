#include "abbe/controls/table_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/controls/carried_text.h"
#include "abbe/controls/table_format.h"
#include "abbe/formats/machine/state_option.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/report/evaluations/statistics_json.h"
#include "abbe/report/words/state_words.h"
#include "abbe/report/words/volumetric_words.h"
#include "abbe/report/words/workpiece_words.h"

namespace abbe {
namespace {

double in_micro(double value) { return 1e6 * value; }
double in_um(double mm) { return 1e3 * mm; }

std::string position_text(double value, bool is_angle) {
  return is_angle ? fmt::format("{:.6g} deg", value / kDegree) : fmt::format("{:.6g} mm", value);
}

std::string errors_carried_text(const ControlTables& made) {
  std::string text;
  text += "each error by itself, without and with its tables (shift of the functional point, rms over the grid):\n";
  text += carried_errors_lines(made.errors);
  text += fmt::format("  limits of the format: {}\n", made.format->cannot);
  for (const auto& [name, words] : made.reversals) text += fmt::format("  {}: {}\n", name, words);
  return text;
}

std::string over_states_text(const LossOverStates& over) {
  const std::size_t worst = over.worst();
  return fmt::format(
             "what they leave at {} states of {}: rms {:.3f} um over all; at most {:.3f} um, at {:.6g} s ({})\n",
             over.time_s.size(), over.record, in_um(over.rms_of_all()), in_um(over.maximum[worst]), over.time_s[worst],
             over.worst_state.empty() ? "no error depends on a state" : state_words(over.worst_state)) +
         (over.outside == 0 ? "" : "warning: " + over.outside_words() + "\n");
}

nlohmann::ordered_json over_states_json(const LossOverStates& over) {
  nlohmann::ordered_json json;
  json["record"] = over.record;
  json["rms_um"] = in_um(over.rms_of_all());
  json["maximum_um"] = in_um(over.maximum[over.worst()]);
  json["maximum_at_s"] = over.time_s[over.worst()];
  add_state(over.worst_state, json);
  if (over.outside > 0) json["outside_measured"] = over.outside;
  json["states"] = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < over.time_s.size(); ++k) {
    json["states"].push_back(
        {{"time_s", over.time_s[k]}, {"rms_um", in_um(over.rms[k])}, {"maximum_um", in_um(over.maximum[k])}});
  }
  return json;
}

}  // namespace

std::string table_text(const TableReport& report) {
  std::string text;
  const ControlTables& made = report.made;
  const TableFormat& format = *made.format;
  text += fmt::format("tables of {} for {}: {}\n", report.machine.name, format.name, format.what);
  text += fmt::format("convention: {}\n", format.convention);
  if (!format.unverified.empty()) text += fmt::format("EXPERIMENTAL, not verified: {}\n", format.unverified);
  const std::vector<TableFigures>& tables = made.tables;
  if (std::any_of(tables.begin(), tables.end(), [](const TableFigures& table) { return table.nodes > 1; })) {
    text += fmt::format(
        "nodes: evenly spaced, so many that straight lines between them stay within {:g} um and {:g} urad\n",
        in_um(made.tolerance_mm), in_micro(made.tolerance_rad));
  }
  for (const TableFigures& table : tables) {
    text += fmt::format("  {:<10} {:>5} {}", table.name, table.nodes, table.nodes == 1 ? "value" : "nodes");
    if (table.step > 0) text += fmt::format(", step {}", position_text(table.step, table.step_is_angle));
    text += fmt::format("; largest correction {}{}", micro_words(table.largest, table.is_angle),
                        table.step > 0 ? " at " + position_text(table.largest_at, table.step_is_angle) : "");
    if (table.nodes > 1) {
      text += fmt::format("; between nodes within {}",
                          table.is_angle ? fmt::format("{:.3f} urad", in_micro(table.interpolation_error))
                                         : fmt::format("{:.4f} um", in_um(table.interpolation_error)));
    }
    if (!table.within) text += " (ABOVE the limit: no more nodes)";
    if (table.standard_uncertainty) {
      text += fmt::format("; standard uncertainty up to {}", micro_words(*table.standard_uncertainty, table.is_angle));
    }
    text += "\n";
  }
  if (tables.empty()) text += "  no table is needed: there are no errors that this format carries\n";
  for (const std::string& name : made.left_out) text += fmt::format("  left out: {}\n", name);
  for (const std::string& name : made.left_out_kept)
    text += fmt::format("  kept, because they are not small together with others: {}\n", name);
  text += state_line(report.partial.at_state) + workpiece_line(made.workpiece);
  text += errors_carried_text(made);
  text += volumetric_text(made.volumetric);
  text += error_line("what these tables leave of it between their nodes", made.left_by_tables);
  if (made.over_states) text += over_states_text(*made.over_states);
  text += fmt::format(
      "displacement of the tool at {} poses between the nodes, datum unchanged, worse direction of "
      "approach:\n",
      made.poses.count());
  text += deviations_line("without tables", made.before);
  text += deviations_line("with these tables", made.after);
  text += deviations_line("ideal compensation", made.ideal);
  if (made.ideal_not_reached > 0) {
    text += fmt::format("  (ideal: the point is not reached at {} poses)\n", made.ideal_not_reached);
  }
  if (made.uncertainty) {
    text += fmt::format("standard uncertainty along that displacement: mean {:.3f}  95 % {:.3f} um\n",
                        in_um(made.uncertainty->mean), in_um(made.uncertainty->p95));
  }
  if (report.partial.is_partial()) text += fmt::format("caution: {}\n", report.partial.caution());
  if (made.largest_mm > 0) {
    text +=
        fmt::format("largest sum of corrections: {} at {}\n", micro_words(made.largest_mm, false), made.largest_mm_at);
  }
  if (made.largest_rad > 0) {
    text +=
        fmt::format("largest sum of corrections: {} at {}\n", micro_words(made.largest_rad, true), made.largest_rad_at);
  }
  for (const std::string& remark : made.settings) text += fmt::format("setting: {}\n", remark);
  for (const std::string& name : report.written) text += fmt::format("{} written\n", name);
  return text;
}

nlohmann::ordered_json table_json(const TableReport& report) {
  const ControlTables& made = report.made;
  nlohmann::ordered_json json;
  json["machine"] = report.machine.name;
  json["format"] = made.format->name;
  json["convention"] = made.format->convention;
  json["unverified"] = made.format->unverified;
  json["tables"] = nlohmann::ordered_json::array();
  for (const TableFigures& table : made.tables) {
    nlohmann::ordered_json one;
    one["name"] = table.name;
    one["nodes"] = table.nodes;
    one[table.step_is_angle ? "step_deg" : "step_mm"] = table.step_is_angle ? table.step / kDegree : table.step;
    const char* const unit = micro_unit(table.is_angle);
    const double scale = micro_per_unit(table.is_angle);
    one[std::string("largest_") + unit] = scale * table.largest;
    one[table.step_is_angle ? "largest_at_deg" : "largest_at_mm"] =
        table.step_is_angle ? table.largest_at / kDegree : table.largest_at;
    one[std::string("interpolation_") + unit] = scale * table.interpolation_error;
    one["interpolation_within_limit"] = table.within;
    if (table.standard_uncertainty) {
      one[std::string("standard_uncertainty_") + unit] = scale * *table.standard_uncertainty;
    }
    json["tables"].push_back(one);
  }
  json["left_out"] = made.left_out;
  json["left_out_kept"] = made.left_out_kept;
  json["refused"] = made.refused;
  json["errors"] = nlohmann::ordered_json::array();
  for (const CarriedError& error : made.errors) {
    nlohmann::ordered_json one = carried_error_json(error);
    for (const auto& [name, words] : made.reversals) {
      if (name == error.name) one["control"] = words;
    }
    json["errors"].push_back(one);
  }
  json["why_not"] = made.format->cannot;
  json["poses"] = made.poses.count();
  add_volumetric_figures(made.volumetric, json);
  json["volumetric_error_left_by_tables_um"] = statistics_um(made.left_by_tables);
  if (made.over_states) json["over_states"] = over_states_json(*made.over_states);
  json["before"] = deviations_json(made.before);
  json["after"] = deviations_json(made.after);
  json["ideal"] = deviations_json(made.ideal);
  json["ideal_not_reached"] = made.ideal_not_reached;
  if (made.uncertainty) json["standard_uncertainty_um"] = statistics_um(*made.uncertainty);
  add_partial_errors(report.partial, json);
  add_workpiece(made.workpiece, json);
  json["largest_correction_um"] = in_um(made.largest_mm);
  json["largest_correction_urad"] = in_micro(made.largest_rad);
  json["settings"] = made.settings;
  json["files"] = report.written;
  return json;
}

}  // namespace abbe
