#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "abbe/machine/machine.h"

namespace abbe {

/// A rotary axis of a machine that turns the workpiece below the tool (or the tool about it) about a given direction.
struct TurningAxis {
  std::size_t axis = 0;
  Eigen::Vector3d direction;  ///< unit, workpiece frame, where the axis then is; on the side of the direction wanted
  double tilt = 0;            ///< rad, between the two
  /// [axes] rad, commands of the rotary axes between the workpiece and this one; others are zero and do not matter
  std::vector<double> positions;
};

/// Direction of an axis in the workpiece frame, unit, at commands of the axes between the workpiece and it.
Eigen::Vector3d axis_direction_in_workpiece(const Machine& machine, std::size_t axis,
                                            const std::vector<double>& positions);

/// The rotary axis that can be brought nearest to a direction of the workpiece by the rotary axes between the two,
/// within their travel; of several as near the one nearest to the workpiece.
/// @param direction  unit, workpiece frame; its sense does not matter
/// @returns nothing if the machine has no rotary axis
std::optional<TurningAxis> turning_axis(const Machine& machine, const Eigen::Vector3d& direction);

}  // namespace abbe
