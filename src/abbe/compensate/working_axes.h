#pragma once

#include <cstddef>
#include <vector>

#include "abbe/machine/inverse_plan.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Which axes of a machine take a correction; all others keep their command.
struct WorkingAxes {
  std::vector<std::size_t> turning;   ///< rotary axes that take the orientation; none: it is only reported
  std::vector<std::size_t> reaching;  ///< linear axes, or the rotary one of a polar machine, that take the point
  std::vector<std::size_t> arm;       ///< of a jointed arm: rotary axes that take both; then the lists above are empty
  std::size_t orientation_rows = 0;   ///< numbers of the orientation that are wanted: 0, 2 (a direction) or 3
};

/// As InverseKinematics decides it. @param kept  axes that keep their command although they could work
WorkingAxes working_axes(const Machine& machine, TargetKind target, const std::vector<HeldAxis>& kept);

}  // namespace abbe
