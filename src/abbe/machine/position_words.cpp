#include "abbe/machine/position_words.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/machine/axis_unit.h"

namespace abbe {

std::string position_words(const Machine& machine, std::span<const double> commands, const char* number) {
  std::string words;
  for (std::size_t i = 0; i < std::min(machine.axes.size(), commands.size()); ++i) {
    const Axis& axis = machine.axes[i];
    words += fmt::format("{}{} {} {}", i == 0 ? "" : ", ", axis.name,
                         fmt::format(fmt::runtime(number), commands[i] / position_unit(axis)), position_suffix(axis));
  }
  return words;
}

}  // namespace abbe
