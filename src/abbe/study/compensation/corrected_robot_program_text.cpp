#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/machine/axis_unit.h"
#include "abbe/report/words/state_words.h"
#include "abbe/study/compensation/corrected_robot_program.h"

namespace abbe {
namespace {

constexpr std::size_t kMostLines = 10;  // of a list in the text; all are in the JSON

/// Index of the corrected position with the largest value, and that value; no position: npos.
template <typename Value>
std::size_t largest_of(const CorrectedRobotProgram& result, const Value& value) {
  std::size_t found = static_cast<std::size_t>(-1);
  for (std::size_t k = 0; k < result.positions.size(); ++k) {
    if (result.positions[k].corrected.empty()) continue;
    if (found == static_cast<std::size_t>(-1) || value(result.positions[k]) > value(result.positions[found])) found = k;
  }
  return found;
}

}  // namespace

std::string corrected_robot_text(const RobotProgramRequest& request, const CorrectedRobotProgram& result,
                                 const std::string& output, bool written) {
  const auto& positions = request.program.positions;
  const auto joints =
      static_cast<std::size_t>(std::count_if(positions.begin(), positions.end(), [](const RobotPosition& position) {
        return position.kind == RobotPositionKind::joints;
      }));
  std::string text = fmt::format("{} program for {}: {} joint positions, {} Cartesian positions\n",
                                 robot_language_name(request.program.language), request.machine.name, joints,
                                 positions.size() - joints);
  text += state_line(request.errors.at_state);
  const auto place = [&](std::size_t k) { return fmt::format("line {}, {}", positions[k].line, positions[k].name); };
  const std::size_t shifted = largest_of(result, [](const auto& p) { return p.shift; });
  if (shifted != static_cast<std::size_t>(-1)) {
    const std::size_t left = largest_of(result, [](const auto& p) { return p.position_left; });
    const std::size_t turned = largest_of(result, [](const auto& p) { return p.orientation_left; });
    text += fmt::format("largest correction of the functional point {:.3f} um, {}\n",
                        1e3 * result.positions[shifted].shift, place(shifted));
    text += fmt::format("rounding of the written digits: at most {:.3f} um, {}; {:.3f} urad, {}\n",
                        1e3 * result.positions[left].position_left, place(left),
                        1e6 * result.positions[turned].orientation_left, place(turned));
  }
  const auto nearest = static_cast<std::size_t>(
      std::count_if(result.positions.begin(), result.positions.end(), [](const auto& p) { return p.is_nearest; }));
  if (nearest > 0) {
    text += fmt::format(
        "{} Cartesian positions fit several axis positions; those nearest to the position before in the "
        "file were taken\n",
        nearest);
  }
  std::size_t listed = 0;
  for (std::size_t k = 0; k < positions.size(); ++k) {
    if (result.positions[k].problem.empty() || ++listed > kMostLines) continue;
    text += fmt::format("  not corrected: {}: {}\n", place(k), result.positions[k].problem);
  }
  if (listed > kMostLines) text += fmt::format("  and {} others\n", listed - kMostLines);
  if (!result.left.empty()) text += fmt::format("{} places are left as they are:\n", result.left.size());
  for (std::size_t k = 0; k < std::min(result.left.size(), kMostLines); ++k)
    text += fmt::format("  line {}: {}\n", result.left[k].line, result.left[k].reason);
  if (result.left.size() > kMostLines) text += fmt::format("  and {} others\n", result.left.size() - kMostLines);
  if (result.has_reversals)
    text += "reversal values are not in this program: a position has no direction of approach\n";
  if (written) text += output + " written\n";
  if (!written && result.refused.empty()) text += "dry run: nothing written\n";
  return text;
}

nlohmann::ordered_json corrected_robot_json(const RobotProgramRequest& request, const CorrectedRobotProgram& result,
                                            const std::string& output, bool written) {
  nlohmann::ordered_json json;
  json["machine"] = request.machine.name;
  json["language"] = robot_language_name(request.program.language);
  add_state(request.errors.at_state, json);
  json["written"] = written;
  json["refused"] = result.refused;
  json["positions"] = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < result.positions.size(); ++k) {
    const RobotPosition& position = request.program.positions[k];
    const CorrectedRobotPosition& corrected = result.positions[k];
    nlohmann::ordered_json row;
    row["name"] = position.name;
    row["line"] = position.line;
    row["kind"] = position.kind == RobotPositionKind::joints ? "joints" : "pose";
    row["problem"] = corrected.problem;
    for (std::size_t i = 0; i < corrected.nominal.size(); ++i) {
      const Axis& axis = request.machine.axes[i];
      const std::string key = axis.name + "_" + position_suffix(axis);
      row["commands"][key] = corrected.nominal[i] / position_unit(axis);
      if (!corrected.corrected.empty()) row["corrected_commands"][key] = corrected.corrected[i] / position_unit(axis);
    }
    if (!corrected.corrected.empty()) {
      row["nearest_to_position_before"] = corrected.is_nearest;
      row["correction_um"] = 1e3 * corrected.shift;
      row["position_left_um"] = 1e3 * corrected.position_left;
      row["orientation_left_urad"] = 1e6 * corrected.orientation_left;
    }
    json["positions"].push_back(row);
  }
  json["left_as_they_are"] = nlohmann::ordered_json::array();
  for (const UncorrectedPosition& left : result.left)
    json["left_as_they_are"].push_back({{"line", left.line}, {"reason", left.reason}});
  json["output"] = output;
  return json;
}

}  // namespace abbe
