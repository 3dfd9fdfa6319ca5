#include "abbe/report/words/corrected_poses_words.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/text/number_text.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/machine/position_words.h"
#include "abbe/report/words/left_out_words.h"

namespace abbe {

std::string poses_csv(const Machine& machine, const CorrectedPoses& result) {
  std::string text;
  for (const Axis& axis : machine.axes) text += axis.name + "_" + position_suffix(axis) + ",";
  text += "status,correction_um,";
  if (!result.uncertainty.empty()) text += "u_correction_um,";
  text += "position_left_um,orientation_left_urad\n";
  // What is not known is an empty field.
  const auto number = [](double value) { return std::isfinite(value) ? shortest_text(value) : std::string(); };
  for (std::size_t k = 0; k < result.status.size(); ++k) {
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      text += number(result.commands.axis[i][k] / position_unit(machine.axes[i])) + ",";
    }
    text += fmt::format("{},{},", correction_status_text(result.status[k]), number(1e3 * result.shift[k]));
    if (!result.uncertainty.empty()) text += number(1e3 * result.uncertainty[k]) + ",";
    text += number(1e3 * result.position_left[k]) + "," + number(1e6 * result.orientation_left[k]) + "\n";
  }
  return text;
}

std::string pose_words(const Machine& machine, const PoseList& poses, std::size_t row) {
  return fmt::format("row {}, {}", row, position_words(machine, poses.pose(row - 1)));
}

std::string poses_text(const Machine& machine, const PoseList& poses, const CorrectedPoses& result,
                       double leave_out_factor) {
  std::string text;
  text += fmt::format("{} poses of {}\n", poses.count(), machine.name);
  for (std::size_t s = 0; s < kCorrectionStatuses; ++s) {
    if (result.count[s] == 0) continue;
    text += fmt::format("  {}: {}{}\n", correction_status_text(static_cast<CorrectionStatus>(s)), result.count[s],
                        s == static_cast<std::size_t>(CorrectionStatus::reached)
                            ? ""
                            : fmt::format(", first in row {}", result.first_row[s]));
  }
  if (result.largest_shift.row > 0) {
    text += fmt::format("largest correction of the functional point {:.3f} um", 1e3 * result.largest_shift.value);
    if (!result.uncertainty.empty())
      text += fmt::format(", standard uncertainty {:.3f} um", 1e3 * result.uncertainty[result.largest_shift.row - 1]);
    text += fmt::format(", {}\n", pose_words(machine, poses, result.largest_shift.row));
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (result.by_axis[i].row == 0) continue;
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    text += fmt::format("  {:<3} {:>10.3f} {:<4}, row {}\n", machine.axes[i].name,
                        micro_per_unit(rotary) * result.by_axis[i].value, micro_unit(rotary), result.by_axis[i].row);
  }
  text += fmt::format(
      "what is left: at most {:.1e} mm{} and {:.1e} rad{}\n", result.largest_position_left.value,
      result.largest_position_left.value > 1e-9 ? fmt::format(" in row {}", result.largest_position_left.row) : "",
      result.largest_orientation_left.value,
      result.largest_orientation_left.value > 1e-11 ? fmt::format(" in row {}", result.largest_orientation_left.row)
                                                    : "");
  if (leave_out_factor > 0) text += left_out_text(machine, leave_out_factor, result.left_out, "");
  return text;
}

nlohmann::ordered_json poses_json(const Machine& machine, const PoseList& poses, const CorrectedPoses& result,
                                  const std::string& output, bool written) {
  nlohmann::ordered_json json;
  json["machine"] = machine.name;
  json["poses"] = poses.count();
  json["written"] = written;
  for (std::size_t s = 1; s < kCorrectionStatuses; ++s)
    json["status"][correction_status_text(static_cast<CorrectionStatus>(s))] = result.count[s];
  json["largest_correction_um"] = 1e3 * result.largest_shift.value;
  json["largest_correction_row"] = result.largest_shift.row;
  if (!result.uncertainty.empty() && result.largest_shift.row > 0)
    json["standard_uncertainty_um"] = 1e3 * result.uncertainty[result.largest_shift.row - 1];
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    json["axes"].push_back({{"axis", machine.axes[i].name},
                            {rotary ? "largest_urad" : "largest_um", micro_per_unit(rotary) * result.by_axis[i].value},
                            {"row", result.by_axis[i].row}});
  }
  json["largest_position_left_um"] = 1e3 * result.largest_position_left.value;
  json["largest_orientation_left_urad"] = 1e6 * result.largest_orientation_left.value;
  state_left_out(machine, result.left_out, json);
  json["output"] = output;
  return json;
}

}  // namespace abbe
