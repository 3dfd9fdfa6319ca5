#pragma once

// Internal to study: mistakes in the axis commands of readings.
#include <functional>
#include <string>
#include <vector>

#include "abbe/machine/machine.h"

namespace abbe {

/// A mistake in axis commands, and what undoes it.
struct AxisMistake {
  std::string words;                         ///< a clause: "axis X is reversed"
  std::function<void(double* pose)> undo{};  ///< commands in chain order, mm or rad; empty: they stay
  int shift = 0;                             ///< reading k was taken with the commands of row k + shift
};

/// Swapped and reversed axes, other units, and commands of the row before or after.
std::vector<AxisMistake> axis_mistakes(const Machine& machine);

}  // namespace abbe
