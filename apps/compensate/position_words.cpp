#include "compensate/position_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/geometry/angle_units.h"

namespace abbe {
std::string position_words(const Machine& machine, std::span<const double> commands, const char* number) {
  std::string words;
  for (std::size_t i = 0; i < std::min(machine.axes.size(), commands.size()); ++i) {
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    words +=
        fmt::format("{}{} {} {}", i == 0 ? "" : ", ", machine.axes[i].name,
                    fmt::format(fmt::runtime(number), commands[i] / (rotary ? kDegree : 1)), rotary ? "deg" : "mm");
  }
  return words;
}

nlohmann::ordered_json position_json(const Machine& machine, std::span<const double> commands) {
  nlohmann::ordered_json json;
  for (std::size_t i = 0; i < std::min(machine.axes.size(), commands.size()); ++i) {
    const bool rotary = machine.axes[i].kind == AxisKind::rotary;
    json[machine.axes[i].name + (rotary ? "_deg" : "_mm")] = commands[i] / (rotary ? kDegree : 1);
  }
  return json;
}

}  // namespace abbe
