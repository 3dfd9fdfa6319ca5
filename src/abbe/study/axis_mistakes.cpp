#include "abbe/study/axis_mistakes.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

struct MistakenCommands {
  AxisKind kind;
  const char* words;
  double factor;  // right = factor * read
};

constexpr std::array<MistakenCommands, 6> kMistakenCommands = {
    {{AxisKind::linear, "the commands of the linear axes are in inch, not in mm", 25.4},
     {AxisKind::linear, "the commands of the linear axes are in mm, not in inch", 1 / 25.4},
     {AxisKind::linear, "the commands of the linear axes are in m, not in mm", 1000},
     {AxisKind::linear, "the commands of the linear axes are in mm, not in m", 1e-3},
     {AxisKind::rotary, "the commands of the rotary axes are in degrees, not in radians", kDegree},
     {AxisKind::rotary, "the commands of the rotary axes are in radians, not in degrees", 1 / kDegree}}};

}  // namespace

std::vector<AxisMistake> axis_mistakes(const Machine& machine) {
  std::vector<AxisMistake> all;
  const std::size_t axes = machine.axes.size();
  for (std::size_t i = 0; i < axes; ++i) {
    for (std::size_t j = i + 1; j < axes; ++j) {
      if (machine.axes[i].kind != machine.axes[j].kind) continue;
      all.push_back({fmt::format("the commands of {} and {} are swapped", machine.axes[i].name, machine.axes[j].name),
                     [i, j](std::vector<double>& pose) { std::swap(pose[i], pose[j]); }});
    }
  }
  for (std::size_t i = 0; i < axes; ++i) {
    all.push_back({fmt::format("axis {} counts in the other direction", machine.axes[i].name),
                   [i](std::vector<double>& pose) { pose[i] = -pose[i]; }});
  }
  for (const MistakenCommands& unit : kMistakenCommands) {
    std::vector<std::size_t> of_kind;
    for (std::size_t i = 0; i < axes; ++i) {
      if (machine.axes[i].kind == unit.kind) of_kind.push_back(i);
    }
    if (of_kind.empty()) continue;
    all.push_back({unit.words, [of_kind, factor = unit.factor](std::vector<double>& pose) {
                     for (const std::size_t i : of_kind) pose[i] *= factor;
                   }});
  }
  all.push_back({"each reading has the commands of the row before", {}, 1});
  all.push_back({"each reading has the commands of the row after", {}, -1});
  return all;
}

}  // namespace abbe
