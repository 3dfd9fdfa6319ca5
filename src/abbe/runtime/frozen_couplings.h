#pragma once

#include <cstddef>

#include "abbe/runtime/frozen_machine.h"
#include "abbe/runtime/frozen_values.h"

// Callers give and take commands; inside stand positions of axes (docs/kinematics.md).

namespace abbe {

/// Position of an axis at commands of all axes.
inline double position_at(const abbe_runtime& machine, const double* commands, std::size_t axis) {
  double position = commands[axis];
  for (std::size_t k = 0; k < machine.couplings; ++k) {
    const FrozenCoupling& coupling = machine.coupling[k];
    if (coupling.axis == axis) position += coupling.ratio * commands[coupling.of];
  }
  return position;
}

/// Commands of positions, or of differences of both; in place.
inline void to_commands(const abbe_runtime& machine, double* positions) {
  // They stand in an order in which the commands that an axis is coupled to are known before it.
  for (std::size_t k = 0; k < machine.couplings; ++k) {
    const FrozenCoupling& coupling = machine.coupling[k];
    positions[coupling.axis] -= coupling.ratio * positions[coupling.of];
  }
}

/// Couplings of a file behind its axes.
void read_frozen_couplings(Values& values, abbe_runtime& m);

/// Whether the commands of the axes that are not found from the point do without those that are.
bool couplings_can_be_solved(const abbe_runtime& m);

}  // namespace abbe
