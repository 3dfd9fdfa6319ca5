#include "abbe/formats/machine/obstacle_option.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {

std::optional<Obstacle> obstacle_on(const Machine& machine, const std::string& carrier) {
  Obstacle obstacle;
  if (carrier == "base") return obstacle;
  if (carrier == "table") {
    obstacle.carrier = ObstacleCarrier::table;
    return obstacle;
  }
  obstacle.carrier = ObstacleCarrier::axis;
  obstacle.axis = machine.find_axis(carrier);
  if (obstacle.axis == Machine::npos) return std::nullopt;
  return obstacle;
}

Obstacle box_obstacle(Obstacle on, const std::array<double, 6>& corners, std::size_t number, const std::string& field,
                      const std::string& form) {
  for (const double corner : corners) {
    if (!(std::abs(corner) <= kLargestInput)) throw InputError({.field = field}, "too large", form);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (corners[k] != corners[k + 3]) continue;
    throw InputError({.field = field}, "a box without volume", "two opposite corners, " + form);
  }
  on.name = fmt::format("box {}", number);
  on.mesh = box_mesh({corners[0], corners[1], corners[2]}, {corners[3], corners[4], corners[5]});
  return on;
}

ObstacleOption obstacle_option(const Machine& machine, const std::string& option, const std::string& text,
                               const std::string& form) {
  const std::size_t equals = text.find('=');
  const std::optional<Obstacle> obstacle = obstacle_on(machine, text.substr(0, equals));
  if (equals == std::string::npos || equals + 1 == text.size() || !obstacle) {
    throw InputError({.field = option + " " + text}, "not understood",
                     form + ", where ON is base, table or an axis of " + machine.chain());
  }
  return {*obstacle, text.substr(equals + 1)};
}

Obstacle box_obstacle_option(const Machine& machine, const std::string& option, const std::string& text,
                             std::size_t number) {
  const std::string form = "ON=X0,Y0,Z0,X1,Y1,Z1 in mm";
  const ObstacleOption read = obstacle_option(machine, option, text, form);
  std::array<double, 6> corners{};
  std::string_view rest = read.contents;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const std::size_t comma = rest.find(',');
    const bool is_last = k + 1 == corners.size();
    if (is_last != (comma == std::string_view::npos) ||
        parse_number(rest.substr(0, comma), 0, corners[k]) != NumberProblem::none) {
      throw InputError({.field = option + " " + text}, "not six numbers with commas between them", form);
    }
    if (!is_last) rest.remove_prefix(comma + 1);
  }
  return box_obstacle(read.obstacle, corners, number, option + " " + text, form);
}

}  // namespace abbe
