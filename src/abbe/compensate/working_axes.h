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
  /// Of an arm: axes that take point and orientation together; then the lists above are empty.
  std::vector<std::size_t> arm;
  bool is_inverted = false;          ///< of an arm: InverseKinematics finds its commands for a target
  std::size_t orientation_rows = 0;  ///< numbers of the orientation that are wanted: 0, 2 (a direction) or 3
};

/// As InverseKinematics decides it, but all rotary axes of a jointed arm work that are neither setting axes nor kept:
/// more of them than the target needs make the change of the commands shorter. Machines that reach a point only by
/// rotary and linear axes together (SCARA, Stanford arm) work with all such axes.
/// @param kept  axes that keep their command although they could work
WorkingAxes working_axes(const Machine& machine, TargetKind target, const std::vector<HeldAxis>& kept);

/// What is asked of single poses: the full pose of an arm, which has axes for it or no others; of other machines, which
/// turn a tool that is round, point and direction.
TargetKind pose_target(const Machine& machine, const std::vector<HeldAxis>& kept);

}  // namespace abbe
