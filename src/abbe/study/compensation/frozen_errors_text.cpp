#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "abbe/controls/lost_motion_words.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/machine/position_words.h"
#include "abbe/report/evaluations/position_json.h"
#include "abbe/report/version.h"
#include "abbe/report/words/left_out_words.h"
#include "abbe/report/words/state_words.h"
#include "abbe/study/compensation/frozen_errors.h"

namespace abbe {
namespace {

/// What is left at the poses that are known to be compensated; never the largest of none.
std::string remaining_text(const FrozenCompensation& frozen) {
  if (frozen.points_compared == 0) return "not known: no pose where the errors are known was reached";
  std::string text = fmt::format("{:.1e} mm", frozen.accuracy);
  if (frozen.directions_compared > 0) text += fmt::format(" and {:.1e} rad", frozen.accuracy_turn);
  text += " at most";
  if (frozen.directions_compared == 0) text += "; the direction of the tool is not corrected";
  if (frozen.unreached > 0) text += fmt::format(" ({} of {} poses)", frozen.points_compared, frozen.poses);
  return text;
}

}  // namespace

std::string frozen_errors_text(const FrozenErrors& result, const FrozenOutput& file) {
  const Machine& machine = result.machine;
  const FrozenCompensation& frozen = result.frozen;
  std::string text;
  text += fmt::format("{}: errors of {} frozen\n", machine.name, result.errors_file);
  text += state_line(result.at_state);
  text += fmt::format("  {}: {} bytes, format {}, abbe {}, checksum {:016x} (machine and errors {:016x})\n",
                      file.written   ? file.file
                      : file.dry_run ? "dry run, nothing written"
                                     : "nothing written",
                      frozen.bytes.size(), frozen.format, version_text(), frozen.checksum, frozen.source_checksum);
  text += fmt::format("  tried at {} poses, tools of {:g} to {:g} mm\n", frozen.poses, result.tool_length_min,
                      result.tool_length_max);
  text +=
      fmt::format("  largest correction of the tool: {:.1f} um at {}, tool {:g} mm\n", 1e3 * frozen.largest_correction,
                  position_words(machine, frozen.where, "{:.4g}"), frozen.tool_length_there);
  text += fmt::format("  largest correction of its direction: {:.1f} urad\n", 1e6 * frozen.largest_correction_turn);
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    text += fmt::format("  largest correction of {}: {:.4g} {}", machine.axes[i].name,
                        frozen.largest_joint[i] * micro_per_unit(rotary), micro_unit(rotary));
    text += fmt::format("{}\n", frozen.largest_joint[i] > 0
                                    ? " at " + position_words(machine, frozen.largest_joint_at[i], "{:.4g}")
                                    : "");
  }
  text += fmt::format("  after it, by the full model{}: {}\n",
                      result.left_out.names.empty() ? "" : " with what is left out", remaining_text(frozen));
  if (frozen.largest_uncertainty > 0) {
    text += fmt::format(
        "  standard uncertainty of the tool's correction: {:.2f} um on average, at most {:.2f} um; in the file to "
        "{:.2f} um\n",
        1e3 * frozen.mean_uncertainty, 1e3 * frozen.largest_uncertainty, 1e3 * frozen.uncertainty_lattice);
  } else {
    text += fmt::format("  standard uncertainty of the tool's correction: not {}\n",
                        frozen.too_many_states ? "in the file, because the errors depend on more than eight states"
                                               : "stated by the errors file");
  }
  if (result.leave_out_factor > 0) text += left_out_text(machine, result.leave_out_factor, result.left_out, "  ");
  for (const FrozenCompensation::Channel& channel : frozen.channels) {
    const MachineState& state = machine.states[channel.state];
    const std::string unit = state.unit == "1" ? "" : " " + state.unit;
    text += fmt::format("  state {}: {:g} to {:g}{}, reference {:g}; moves the tool by up to {:.1f} um from there\n",
                        state.name, channel.range.from, channel.range.to, unit, state.reference, 1e3 * channel.largest);
  }
  text += fmt::format("  iterations of one call: at most {}\n", frozen.worst_iterations);
  if (frozen.limited > 0)
    text +=
        fmt::format("  near singularities the turn is bounded: at {} poses a part of the orientation error remains\n",
                    frozen.limited);
  if (frozen.unreached > 0)
    text +=
        fmt::format("  the axes cannot correct all of the error of the point: at {} of {} poses a part of it remains\n",
                    frozen.unreached, frozen.poses);
  return text + linuxcnc_backlash_text(machine, result.errors);
}

nlohmann::ordered_json frozen_errors_json(const FrozenErrors& result, const FrozenOutput& file) {
  const Machine& machine = result.machine;
  const FrozenCompensation& frozen = result.frozen;
  nlohmann::ordered_json json;
  json["machine"] = machine.name;
  json["errors"] = result.errors_file;
  add_state(result.at_state, json);
  json["output"] = file.file;
  json["written"] = file.written;
  json["bytes"] = frozen.bytes.size();
  json["format"] = frozen.format;
  json["version"] = version_text();
  json["checksum"] = fmt::format("{:016x}", frozen.checksum);
  json["source_checksum"] = fmt::format("{:016x}", frozen.source_checksum);
  json["poses"] = frozen.poses;
  json["largest_correction_um"] = 1e3 * frozen.largest_correction;
  json["largest_correction_urad"] = 1e6 * frozen.largest_correction_turn;
  nlohmann::ordered_json joints;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    joints[machine.axes[i].name + (rotary ? "_deg" : "_um")] = frozen.largest_joint[i] * (rotary ? 1 / kDegree : 1e3);
  }
  json["largest_correction_at"] = position_json(machine, frozen.where);
  json["largest_joint_corrections"] = joints;
  // null: the largest of nothing.
  const auto known = [](std::size_t count, double value) {
    return count > 0 ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
  };
  json["accuracy_mm"] = known(frozen.points_compared, frozen.accuracy);
  json["accuracy_rad"] = known(frozen.directions_compared, frozen.accuracy_turn);
  json["difference_by_freezing_mm"] = known(frozen.points_compared, frozen.difference);
  json["points_compared"] = frozen.points_compared;
  json["directions_compared"] = frozen.directions_compared;
  if (frozen.largest_uncertainty > 0) {
    json["largest_standard_uncertainty_um"] = 1e3 * frozen.largest_uncertainty;
    json["mean_standard_uncertainty_um"] = 1e3 * frozen.mean_uncertainty;
    json["standard_uncertainty_in_file_to_um"] = 1e3 * frozen.uncertainty_lattice;
  }
  state_left_out(machine, result.left_out, json);
  for (const FrozenCompensation::Channel& channel : frozen.channels) {
    const MachineState& state = machine.states[channel.state];
    json["states"].push_back({{"name", state.name},
                              {"unit", state.unit},
                              {"reference", state.reference},
                              {"range", {channel.range.from, channel.range.to}},
                              {"largest_um", 1e3 * channel.largest}});
  }
  json["backlash"] = nlohmann::ordered_json::array();
  for (const JointBacklash& one : linuxcnc_backlash(machine, result.errors)) {
    json["backlash"].push_back({{"axis", one.axis},
                                {"setting", one.setting},
                                {one.rotary ? "lost_motion_deg" : "lost_motion_mm", one.lost_motion}});
  }
  json["worst_iterations"] = frozen.worst_iterations;
  json["turn_bounded"] = frozen.limited;
  json["point_not_reached"] = frozen.unreached;
  return json;
}

}  // namespace abbe
