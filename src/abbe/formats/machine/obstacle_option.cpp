#include "abbe/formats/machine/obstacle_option.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {

ObstacleOption obstacle_option(const Machine& machine, const std::string& option, const std::string& text,
                               const std::string& form) {
  const std::size_t equals = text.find('=');
  const std::string carrier = text.substr(0, equals);
  ObstacleOption result;
  if (carrier == "base") {
    result.obstacle.carrier = ObstacleCarrier::base;
  } else if (carrier == "table") {
    result.obstacle.carrier = ObstacleCarrier::table;
  } else {
    result.obstacle.carrier = ObstacleCarrier::axis;
    result.obstacle.axis = machine.find_axis(carrier);
  }
  if (equals == std::string::npos || equals + 1 == text.size() || result.obstacle.axis == Machine::npos) {
    throw InputError({.field = option + " " + text}, "not understood",
                     form + ", where ON is base, table or an axis of " + machine.chain());
  }
  result.contents = text.substr(equals + 1);
  return result;
}

Obstacle box_obstacle_option(const Machine& machine, const std::string& option, const std::string& text,
                             std::size_t number) {
  const std::string form = "ON=X0,Y0,Z0,X1,Y1,Z1 in mm";
  ObstacleOption read = obstacle_option(machine, option, text, form);
  const auto fail = [&](const std::string& problem, const std::string& expected) {
    throw InputError({.field = option + " " + text}, problem, expected);
  };
  std::array<double, 6> corners{};
  std::string_view rest = read.contents;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const std::size_t comma = rest.find(',');
    const bool is_last = k + 1 == corners.size();
    if (is_last != (comma == std::string_view::npos) ||
        parse_number(rest.substr(0, comma), 0, corners[k]) != NumberProblem::none) {
      fail("not six numbers with commas between them", form);
    }
    if (!(std::abs(corners[k]) <= kLargestInput)) fail("too large", form);
    if (!is_last) rest.remove_prefix(comma + 1);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (corners[k] == corners[k + 3]) fail("a box without volume", "two opposite corners, " + form);
  }
  read.obstacle.name = fmt::format("box {}", number);
  read.obstacle.mesh = box_mesh({corners[0], corners[1], corners[2]}, {corners[3], corners[4], corners[5]});
  return std::move(read.obstacle);
}

}  // namespace abbe
