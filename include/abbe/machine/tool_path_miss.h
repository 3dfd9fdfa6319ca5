#pragma once

#include "abbe/machine/machine.h"
#include "abbe/machine/tool_path.h"

namespace abbe {

/// How far a tool is from the points of its curve.
struct ToolPathMiss {
  double distance = 0;  ///< mm
  double angle = 0;     ///< rad
};

/// Largest distance and angle of the tool from the points of the curve, by the forward kinematics.
/// @param path  of this curve on this machine, followed
ToolPathMiss largest_miss(const Machine& machine, const Curve& curve, const ToolPath& path);

}  // namespace abbe
