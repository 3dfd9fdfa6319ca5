#include "abbe/report/words/program_words.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/machine/axis_unit.h"
#include "abbe/machine/position_words.h"
#include "abbe/report/evaluations/position_json.h"
#include "abbe/report/words/left_out_words.h"
#include "abbe/report/words/state_words.h"
#include "abbe/report/words/workpiece_words.h"

namespace abbe {
namespace {

/// "-12 um", "35 urad".
std::string reversal_size(const Machine& machine, std::size_t axis, double value) {
  const bool rotary = machine.axes[axis].kind == AxisKind::rotary;
  return fmt::format("{:.4g} {}", micro_per_unit(rotary) * value, micro_unit(rotary));
}

const StatusCount& status_count(const ProgramReport& report, CorrectionStatus status) {
  return report.status[static_cast<std::size_t>(status)];
}

std::string lines_text(const StatusCount& count) {
  std::string text;
  std::size_t shown = 0;
  for (const std::size_t line : count.line) {
    if (line == 0) break;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", line);
    ++shown;
  }
  const std::string name = shown == 1 ? "line " : "lines ";
  return name + text + (shown == StatusCount::kLines && count.count > shown ? " ..." : "");
}

nlohmann::ordered_json count_json(const StatusCount& count) {
  nlohmann::ordered_json json;
  json["count"] = count.count;
  json["first_lines"] = nlohmann::ordered_json::array();
  for (const std::size_t line : count.line) {
    if (line != 0) json["first_lines"].push_back(line);
  }
  return json;
}

/// Axes that a place has outside their travel.
std::string travel_text(const Machine& machine, const ProgramPlace& place) {
  std::string text;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    if (axis.endless || (place.position[i] >= axis.travel_min && place.position[i] <= axis.travel_max)) continue;
    const double unit = position_unit(axis);
    text += fmt::format("; the travel of {} is {:g} to {:g} {}", axis.name, axis.travel_min / unit,
                        axis.travel_max / unit, position_suffix(axis));
  }
  return text;
}

std::string reversals_text(const Machine& machine, const CorrectedProgram& result) {
  std::string text;
  for (std::size_t r = 0; r < result.reversals.size(); ++r) {
    const ReversalAxis& axis = result.reversals[r];
    const StatusCount& taken_up = result.report.take_ups[axis.axis];
    const StatusCount& unknown = result.report.direction_unknown[axis.axis];
    const std::string& name = machine.axes[axis.axis].name;
    text += axis.value == 0 ? "side of approach of " + name
                            : fmt::format("reversal of {} {}", name, reversal_size(machine, axis.axis, axis.value));
    if (result.reversal_uncertainty[r] > 0) {
      text +=
          fmt::format(", standard uncertainty {}", reversal_size(machine, axis.axis, result.reversal_uncertainty[r]));
    }
    text += fmt::format(": {} {} time{}", axis.value == 0 ? "changed" : "taken up", taken_up.count,
                        taken_up.count == 1 ? "" : "s");
    if (taken_up.count > 0) text += fmt::format(", {}", lines_text(taken_up));
    // Longer tools make it smaller for rotary axes.
    const bool rotary = machine.axes[axis.axis].kind == AxisKind::rotary;
    text +=
        fmt::format("; dead band {}{}\n", rotary ? "at most " : "", reversal_size(machine, axis.axis, axis.dead_band));
    if (unknown.count > 0) {
      text += fmt::format("  nothing is added before {} has moved: {} pose{}, {}\n", machine.axes[axis.axis].name,
                          unknown.count, unknown.count == 1 ? "" : "s", lines_text(unknown));
    }
    if (axis.value > 0) {
      text += fmt::format(
          "  a value above zero is not lost motion: where {} reverses, the take-up motion moves the axis itself\n",
          machine.axes[axis.axis].name);
    }
  }
  return text;
}

nlohmann::ordered_json reversals_json(const Machine& machine, const CorrectedProgram& result) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (std::size_t r = 0; r < result.reversals.size(); ++r) {
    const ReversalAxis& axis = result.reversals[r];
    const bool rotary = machine.axes[axis.axis].kind == AxisKind::rotary;
    const std::string unit = std::string("_") + micro_unit(rotary);
    const double factor = micro_per_unit(rotary);
    nlohmann::ordered_json one;
    one["axis"] = machine.axes[axis.axis].name;
    one["value" + unit] = factor * axis.value;
    if (result.reversal_uncertainty[r] > 0)
      one["standard_uncertainty" + unit] = factor * result.reversal_uncertainty[r];
    one["dead_band" + unit] = factor * axis.dead_band;
    one["taken_up"] = count_json(result.report.take_ups[axis.axis]);
    one["direction_not_known"] = count_json(result.report.direction_unknown[axis.axis]);
    all.push_back(one);
  }
  return all;
}

struct NamedStatus {
  CorrectionStatus status;
  const char* text;
};
constexpr NamedStatus kStatuses[] = {
    {CorrectionStatus::orientation_left, "the point is reached, but the machine cannot correct the orientation error"},
    {CorrectionStatus::turn_limited, "near a singularity the turn is bounded, so some orientation error remains"},
    {CorrectionStatus::position_left, "the machine does not reach the point"},
    {CorrectionStatus::outside_travel, "the corrected position is outside the travel and was kept at its end"},
    {CorrectionStatus::not_covered, "the errors are not known there"},
    {CorrectionStatus::not_converged, "no correction was found"},
    {CorrectionStatus::not_finite, "a position is not a number"}};

}  // namespace

std::string given_up_words(const std::string& program, const ProgramLimits& limits, const NcProgramResult& text) {
  const std::string place = fmt::format("{}:{}: given up", program, text.given_up_line);
  switch (text.spent) {
    case ProgramBudget::Spent::nothing:
      return {};
    case ProgramBudget::Spent::bytes:
      return fmt::format(
          "{} after {} moves: the corrected program would be longer than {:.6g} MB; --max-output-mb allows more", place,
          text.moves, limits.megabytes);
    case ProgramBudget::Spent::time:
      return fmt::format("{} after {} moves: it takes longer than {:.6g} min; --max-minutes allows more", place,
                         text.moves, limits.minutes);
    case ProgramBudget::Spent::pieces:
      break;
  }
  return fmt::format(
      "{}: moves that are corrected together become more than {} pieces; a larger --tolerance-um makes fewer", place,
      ProgramBudget::kMostPieces);
}

std::vector<std::string> reasons_to_refuse(double limit_um, const AllowedProblems& allowed, const Machine& machine,
                                           const ProgramReport& report) {
  std::vector<std::string> reasons;
  const auto add = [&](const StatusCount& count, bool is_allowed, const std::string& text, const char* allow,
                       const ProgramPlace& first = {}, const char* counted = "pose") {
    if (count.count == 0 || is_allowed) return;
    std::string reason =
        fmt::format("{}: {} {}{}, {}", text, count.count, counted, count.count == 1 ? "" : "s", lines_text(count));
    if (first.line != 0)
      reason +=
          fmt::format(", first at {}", position_words(machine, first.position, "{:.3f}") + travel_text(machine, first));
    if (allow != nullptr) reason += fmt::format(" (--allow {} to write it all the same)", allow);
    reasons.push_back(reason);
  };
  const auto first_place = [&](CorrectionStatus status) -> const ProgramPlace& {
    return report.first_place[static_cast<std::size_t>(status)];
  };
  add(report.above_limit, false, fmt::format("correction above the limit of {:g} um", limit_um), nullptr);
  if (report.above_limit.count > 0) {
    reasons.back() +=
        fmt::format(", the largest {:.3f} um in line {} at {}", 1e3 * report.largest_shift.value,
                    report.largest_shift.line, position_words(machine, report.largest_shift.position, "{:.3f}"));
  }
  add(status_count(report, CorrectionStatus::not_covered), allowed.not_covered,
      "outside the range over which the errors are known", "not-covered", first_place(CorrectionStatus::not_covered));
  add(status_count(report, CorrectionStatus::outside_travel), allowed.outside_travel,
      "corrected position outside the travel", "outside-travel", first_place(CorrectionStatus::outside_travel));
  add(report.held_starts, allowed.held_start,
      fmt::format("work that begins at the end of a travel that its correction would leave, so that the point is off "
                  "by at most {:.3f} um there; begin it further inside the travel",
                  1e3 * report.largest_held_start.value),
      "held-start");
  add(status_count(report, CorrectionStatus::position_left), allowed.position_left, "point not reached",
      "position-left", first_place(CorrectionStatus::position_left));
  add(status_count(report, CorrectionStatus::not_converged), allowed.not_converged, "no correction found",
      "not-converged", first_place(CorrectionStatus::not_converged));
  add(status_count(report, CorrectionStatus::not_finite), false, "position that is not a number", nullptr);
  add(report.bent_with_spindle, allowed.not_proven,
      fmt::format(
          "threads or taps, which are not split, not proven to stay within the tolerance, at most {:.3f} um from "
          "their path",
          1e3 * report.largest_bend.value),
      "not-proven", {}, "move");
  add(report.play_with_spindle, false,
      "threads or taps in which axes with reversal values reverse, which cannot be taken up there (where they reverse "
      "only for a correction, use a larger --reversal-dead-band-um)",
      nullptr, {}, "move");
  add(report.not_proven, allowed.not_proven, "path between corrected poses not proven to stay within the tolerance",
      "not-proven", {}, "move");
  return reasons;
}

std::string program_text(const ProgramWordsRequest& request, const Machine& machine, const CorrectedProgram& result) {
  std::string text;
  const ProgramReport& report = result.report;
  text += fmt::format("{} moves of {} on {}: {} pieces, {} split; path within {:g} um between them\n", report.moves,
                      request.program, machine.name, report.pieces, report.split_moves, request.tolerance_um);
  text += state_line(result.at_state) + workpiece_line(result.workpiece);
  const ProgramPlace& shift = report.largest_shift;
  if (shift.line != 0) {
    text += fmt::format("largest correction of the functional point {:.3f} um", 1e3 * shift.value);
    if (result.largest.stated) text += fmt::format(", standard uncertainty {:.3f} um", 1e3 * result.largest.point);
    text += fmt::format(", line {}, {}\n", shift.line, position_words(machine, shift.position, "{:.3f}"));
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const ProgramPlace& place = report.by_axis[i];
    if (place.line == 0) continue;
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    const double unit = micro_per_unit(rotary);
    text += fmt::format("  {:<3} {:>10.3f} {:<4}", machine.axes[i].name, unit * place.value, micro_unit(rotary));
    if (result.by_axis[i].axes_known) text += fmt::format(" u {:.3f}", unit * result.by_axis[i].axis[i]);
    text += fmt::format(", line {}\n", place.line);
  }
  text += reversals_text(machine, result);
  if (report.largest_orientation_left.value > 1e-9) {
    text += fmt::format("largest remaining orientation error {:.3f} urad, line {}\n",
                        1e6 * report.largest_orientation_left.value, report.largest_orientation_left.line);
  }
  for (const NamedStatus& named : kStatuses) {
    const StatusCount& count = status_count(report, named.status);
    if (count.count == 0) continue;
    text += fmt::format("{}: {} pose{}, {}: {}\n", correction_status_text(named.status), count.count,
                        count.count == 1 ? "" : "s", lines_text(count), named.text);
  }
  if (report.held_at_travel.count > 0) {
    text += fmt::format(
        "rapid moves kept at the end of a travel, because the correction points outwards: {} pose{}, {}; the point "
        "misses its place by at most {:.3f} um, in line {}\n",
        report.held_at_travel.count, report.held_at_travel.count == 1 ? "" : "s", lines_text(report.held_at_travel),
        1e3 * report.largest_held.value, report.largest_held.line);
  }
  if (report.held_starts.count > 0) {
    text += fmt::format(
        "work that begins at the end of a travel that its correction would leave: {} move{}, {}; the point is off "
        "by at most {:.3f} um there, and within the tolerance once the correction is within the travel\n",
        report.held_starts.count, report.held_starts.count == 1 ? "" : "s", lines_text(report.held_starts),
        1e3 * report.largest_held_start.value);
  }
  if (report.not_proven.count > 0) {
    text += fmt::format("not proven to stay within the tolerance: {} move{}, {}\n", report.not_proven.count,
                        report.not_proven.count == 1 ? "" : "s", lines_text(report.not_proven));
  }
  if (report.tool_changes.count > 0) {
    text +=
        fmt::format("moves that begin with another tool length in force: {} move{}, {}\n", report.tool_changes.count,
                    report.tool_changes.count == 1 ? "" : "s", lines_text(report.tool_changes));
  }
  if (report.inverse_time.count > 0) {
    text += fmt::format("inverse time feeds, to keep the durations: {} pieces, {}\n", report.inverse_time.count,
                        lines_text(report.inverse_time));
  }
  if (result.text.uncorrected_moves > 0) {
    text += fmt::format(
        "rapid moves not corrected, because the program had not yet moved some axis: {}, first in line {}\n",
        result.text.uncorrected_moves, result.text.first_uncorrected_line);
  }
  if (result.text.first_assumed_offset_line > 0) {
    text +=
        fmt::format("work offset taken as zero, because neither --parameters nor the program states it: from line {}\n",
                    result.text.first_assumed_offset_line);
  }
  if (request.leave_out_factor > 0) text += left_out_text(machine, request.leave_out_factor, result.left_out, "");
  if (!result.refused.empty()) return text;
  if (request.dry_run) {
    text += "dry run: nothing written\n";
  } else {
    text += fmt::format("{} written\n", request.output);
  }
  return text;
}

nlohmann::ordered_json program_json(const ProgramWordsRequest& request, const Machine& machine,
                                    const CorrectedProgram& result) {
  const ProgramReport& report = result.report;
  nlohmann::ordered_json json;
  json["program"] = request.program;
  json["machine"] = machine.name;
  add_state(result.at_state, json);
  add_workpiece(result.workpiece, json);
  json["written"] = result.refused.empty() && !request.dry_run;
  json["refused"] = result.refused;
  json["lines"] = result.text.lines;
  json["moves"] = report.moves;
  json["pieces"] = report.pieces;
  json["split_moves"] = report.split_moves;
  json["tolerance_um"] = request.tolerance_um;
  if (report.largest_shift.line != 0) {
    nlohmann::ordered_json& largest = json["largest_correction"];
    largest["value_um"] = 1e3 * report.largest_shift.value;
    if (result.largest.stated) largest["standard_uncertainty_um"] = 1e3 * result.largest.point;
    largest["line"] = report.largest_shift.line;
    largest["position"] = position_json(machine, report.largest_shift.position);
  }
  json["axes"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const ProgramPlace& place = report.by_axis[i];
    if (place.line == 0) continue;
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    const std::string unit = std::string("_") + micro_unit(rotary);
    const double factor = micro_per_unit(rotary);
    nlohmann::ordered_json axis;
    axis["axis"] = machine.axes[i].name;
    axis["largest" + unit] = factor * place.value;
    if (result.by_axis[i].axes_known) axis["standard_uncertainty" + unit] = factor * result.by_axis[i].axis[i];
    axis["line"] = place.line;
    json["axes"].push_back(axis);
  }
  json["reversals"] = reversals_json(machine, result);
  json["largest_orientation_left_urad"] = 1e6 * report.largest_orientation_left.value;
  for (std::size_t i = 1; i < kCorrectionStatuses; ++i) {
    json["poses"][correction_status_text(static_cast<CorrectionStatus>(i))] = count_json(report.status[i]);
  }
  json["held_at_travel"] = count_json(report.held_at_travel);
  json["held_at_travel"]["largest_left_um"] = 1e3 * report.largest_held.value;
  json["held_starts"] = count_json(report.held_starts);
  json["held_starts"]["largest_left_um"] = 1e3 * report.largest_held_start.value;
  json["bent_with_spindle"] = count_json(report.bent_with_spindle);
  json["bent_with_spindle"]["largest_um"] = 1e3 * report.largest_bend.value;
  json["not_proven"] = count_json(report.not_proven);
  json["above_limit"] = count_json(report.above_limit);
  json["tool_length_changes"] = count_json(report.tool_changes);
  json["inverse_time_pieces"] = count_json(report.inverse_time);
  json["uncorrected_rapid_moves"] = result.text.uncorrected_moves;
  if (result.text.given_up_line > 0) json["given_up_line"] = result.text.given_up_line;
  json["first_line_in_assumed_work_offset"] = result.text.first_assumed_offset_line;
  state_left_out(machine, result.left_out, json);
  return json;
}

}  // namespace abbe
