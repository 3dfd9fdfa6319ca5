#include "abbe/study/identification/axis_mistakes.h"

#include <fmt/format.h>

#include <utility>

#include "abbe/instruments/reading_mistakes.h"

namespace abbe {
std::vector<AxisMistake> axis_mistakes(const Machine& machine) {
  std::vector<AxisMistake> all;
  const std::size_t axes = machine.axes.size();
  for (std::size_t i = 0; i < axes; ++i) {
    for (std::size_t j = i + 1; j < axes; ++j) {
      if (machine.axes[i].kind != machine.axes[j].kind) continue;
      all.push_back({fmt::format("the commands of {} and {} are swapped", machine.axes[i].name, machine.axes[j].name),
                     [i, j](double* pose) { std::swap(pose[i], pose[j]); }});
    }
  }
  for (std::size_t i = 0; i < axes; ++i) {
    all.push_back({fmt::format("axis {} counts in the other direction", machine.axes[i].name),
                   [i](double* pose) { pose[i] = -pose[i]; }});
  }
  const auto add_units = [&](AxisKind kind, const char* name, const auto& mistakes_of) {
    std::vector<std::size_t> of_kind;
    for (std::size_t i = 0; i < axes; ++i) {
      if (machine.axes[i].kind == kind) of_kind.push_back(i);
    }
    if (of_kind.empty()) return;
    for (ReadingMistake& mistake : mistakes_of(of_kind, fmt::format("the commands of the {} axes", name))) {
      all.push_back({mistake.words.front(), std::move(mistake.undo)});
    }
  };
  add_units(AxisKind::linear, "linear", length_unit_mistakes);
  add_units(AxisKind::rotary, "rotary", angle_unit_mistakes);
  all.push_back({"each reading has the commands of the row before", {}, 1});
  all.push_back({"each reading has the commands of the row after", {}, -1});
  return all;
}

}  // namespace abbe
