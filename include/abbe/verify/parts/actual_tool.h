#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Where a machine's tool really is, in the workpiece frame.
struct ToolPlaces {
  Eigen::Matrix3Xd point;             ///< [3, n] functional point, mm
  Eigen::Matrix3Xd direction;         ///< [3, n] unit, from it to the spindle
  std::vector<std::uint8_t> covered;  ///< [n] 0: outside the range of an error motion, an extrapolation
};

/// Tool of a machine with errors at commands. Where the list knows the approach, reversal values act (Reversal).
/// @param commands  [axes][n]
/// @throws std::invalid_argument if the commands do not fit the machine
ToolPlaces actual_tool(const Machine& machine, const ErrorSet& errors, const PoseList& commands);

/// What axes with reversal values make of commands that follow each other in time: the play operator.
///
/// With lost motion (reversal value B < 0) an axis rests until its command has gone |B| the other way, and then follows
/// |B| / 2 behind it: y = max(c - |B|/2, min(c + |B|/2, y before)). At the end of every motion longer than |B| that is
/// q + approach B / 2, as Reversal says; in between it is the way there. With B > 0 the axis is as much ahead. The
/// first command is taken as reached from the middle.
/// @param commands  [axes][n] in the order of time; an approach in it is not looked at
/// @return [axes][n] where the axes stand, without approach
/// Source: A. Visintin, Differential Models of Hysteresis (1994), III.2 (play).
PoseList positions_with_play(const ErrorSet& errors, const PoseList& commands);

}  // namespace abbe
