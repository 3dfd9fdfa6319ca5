#include "abbe/report/words/path_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/geometry/angle_units.h"
#include "abbe/machine/axis_unit.h"

namespace abbe {

std::string path_text(const Machine& machine, const ToolPath& path, const ToolPathMiss& miss) {
  std::string text;
  text += fmt::format("{} moves of {} in {} region{}, {} poses inserted\n", path.steps.size(), machine.name,
                      path.regions, path.regions == 1 ? "" : "s", path.inserted);
  text += fmt::format("length at work {:.3f} mm, {:.2f} s at the feeds, without acceleration\n", path.working_length,
                      path.working_time);
  text += fmt::format(
      "tool off the straight lines between the points by at most {:.3f} um; at the points by {:.1e} mm and {:.1e} "
      "rad\n",
      1e3 * path.largest_deviation, miss.distance, miss.angle);
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    double low = path.steps[0].command[i], high = low;
    for (const ToolPathStep& step : path.steps) {
      low = std::min(low, step.command[i]);
      high = std::max(high, step.command[i]);
    }
    const double unit = position_unit(machine.axes[i]);
    text += fmt::format("  {:<3} {:>12.4f} to {:>12.4f} {}\n", machine.axes[i].name, low / unit, high / unit,
                        position_suffix(machine.axes[i]));
  }
  for (const PathJump& jump : path.jumps) {
    text += fmt::format("  move {}: {} turns {:.1f} deg, linear axes {:.1f} mm{}\n", jump.pose + 1,
                        machine.axes[jump.axis].name, jump.turn / kDegree, jump.largest_linear_move,
                        path.steps[jump.pose].working ? ", at work" : "");
  }
  return text;
}

nlohmann::ordered_json path_json(const Machine& machine, const ToolPath& path, const ToolPathMiss& miss) {
  nlohmann::ordered_json json;
  json["machine"] = machine.name;
  json["status"] = path.status == ToolPathStatus::followed ? "followed" : "jumps_while_working";
  json["moves"] = path.steps.size();
  json["regions"] = path.regions;
  json["inserted"] = path.inserted;
  json["length_mm"] = path.working_length;
  json["time_s"] = path.working_time;
  json["largest_deviation_um"] = 1e3 * path.largest_deviation;
  json["largest_miss_mm"] = miss.distance;
  json["largest_miss_rad"] = miss.angle;
  json["jumps"] = nlohmann::ordered_json::array();
  for (const PathJump& jump : path.jumps) {
    json["jumps"].push_back({{"move", jump.pose + 1},
                             {"axis", machine.axes[jump.axis].name},
                             {"turn_deg", jump.turn / kDegree},
                             {"largest_linear_move_mm", jump.largest_linear_move},
                             {"at_work", path.steps[jump.pose].working}});
  }
  return json;
}

std::vector<std::pair<std::string, std::string>> path_facts(const std::string& curve, const ToolPath& path) {
  return {{"curve", curve},
          {"moves", fmt::format("{} in {} region{}", path.steps.size(), path.regions, path.regions == 1 ? "" : "s")},
          {"at work", fmt::format("{:.3f} mm, {:.2f} s at the feeds", path.working_length, path.working_time)},
          {"off the straight lines", fmt::format("at most {:.3f} \xC2\xB5m", 1e3 * path.largest_deviation)}};
}

}  // namespace abbe
