#include "abbe/report/evaluations/position_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/machine/axis_unit.h"

namespace abbe {

nlohmann::ordered_json position_json(const Machine& machine, std::span<const double> commands) {
  nlohmann::ordered_json json;
  for (std::size_t i = 0; i < std::min(machine.axes.size(), commands.size()); ++i) {
    const Axis& axis = machine.axes[i];
    json[axis.name + "_" + position_suffix(axis)] = commands[i] / position_unit(axis);
  }
  return json;
}

}  // namespace abbe
