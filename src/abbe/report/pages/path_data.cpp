#include "abbe/report/pages/path_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "abbe/machine/axis_unit.h"

namespace abbe {
namespace {

std::vector<std::size_t> kept_moves(const std::vector<DrawnMove>& moves, std::size_t most) {
  std::vector<std::size_t> kept;
  const std::size_t n = moves.size();
  std::size_t changes = 0;
  for (std::size_t i = 1; i < n; ++i) changes += moves[i].working != moves[i - 1].working ? 2 : 0;
  // So many beginnings that nothing else would be left: evenly chosen ones only.
  const bool with_changes = changes < most / 2;
  const std::size_t room = std::max<std::size_t>(2, with_changes ? most - changes : most);
  const std::size_t every = std::max<std::size_t>(1, (n + room - 1) / room);
  for (std::size_t i = 0; i < n; ++i) {
    const bool changed = with_changes && ((i > 0 && moves[i].working != moves[i - 1].working) ||
                                          (i + 1 < n && moves[i].working != moves[i + 1].working));
    if (i % every == 0 || i + 1 == n || changed) kept.push_back(i);
  }
  return kept;
}

/// Seven significant digits: it is only drawn.
double drawn(double value) { return std::strtod(fmt::format("{:.7g}", value).c_str(), nullptr); }

}  // namespace

nlohmann::json path_data(const Machine& machine, const PathPicture& path, std::size_t most) {
  const std::vector<std::size_t> kept = kept_moves(path.moves, most);
  const auto column = [&](auto value) {
    nlohmann::json numbers = nlohmann::json::array();
    for (const std::size_t i : kept) numbers.push_back(drawn(value(path.moves[i])));
    return numbers;
  };
  nlohmann::json json;
  json["title"] = path.title;
  json["moves"] = path.moves.size();
  json["time_s"] = column([](const DrawnMove& move) { return move.time; });
  json["working"] = nlohmann::json::array();
  for (const std::size_t i : kept) json["working"].push_back(path.moves[i].working ? 1 : 0);
  json["axes"] = nlohmann::json::array();
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    const double unit = 1 / position_unit(axis);
    const std::string key = axis.name + "_" + position_suffix(axis);
    json["axes"].push_back(key);
    json["commands"][key] = column([&](const DrawnMove& move) { return unit * move.command[i]; });
    if (!axis.endless) json["travel"][key] = {drawn(unit * axis.travel_min), drawn(unit * axis.travel_max)};
  }
  static constexpr const char* kNames[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    json["point_mm"][kNames[k]] = column([k](const DrawnMove& move) { return move.point[k]; });
    json["direction"][kNames[k]] = column([k](const DrawnMove& move) { return move.direction[k]; });
  }
  const auto any = [&](auto has) { return std::any_of(path.moves.begin(), path.moves.end(), has); };
  if (any([](const DrawnMove& move) { return move.feed > 0; })) {
    json["feed_mm_per_min"] = column([](const DrawnMove& move) { return move.feed; });
  }
  if (any([](const DrawnMove& move) { return move.length > 0; })) {
    json["length_mm"] = column([](const DrawnMove& move) { return move.length; });
  }
  json["tool"]["kind"] = path.tool;
  if (path.tool_radius > 0) json["tool"]["radius_mm"] = path.tool_radius;
  if (path.tool_length > 0) json["tool"]["length_mm"] = path.tool_length;
  if (path.working_distance > 0) json["tool"]["working_distance_mm"] = path.working_distance;
  if (!path.note.empty()) json["note"] = path.note;
  return json;
}

}  // namespace abbe
