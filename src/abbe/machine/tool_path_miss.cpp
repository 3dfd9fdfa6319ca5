#include "abbe/machine/tool_path_miss.h"

#include <algorithm>
#include <span>

#include "abbe/geometry/angle.h"

namespace abbe {

ToolPathMiss largest_miss(const Machine& machine, const Curve& curve, const ToolPath& path) {
  ToolPathMiss miss;
  for (const ToolPathStep& step : path.steps) {
    if (step.point == ToolPathStep::kNoPoint) continue;
    const RigidTransform pose =
        nominal_workpiece_from_tool(machine, std::span(step.command).first(machine.axes.size()));
    const CurvePoint& at = curve.points[step.point];
    const Eigen::Vector3d direction = pose.rotation * machine.tool_direction;
    miss.distance = std::max(miss.distance, (pose.translation - at.point).norm());
    miss.angle = std::max(miss.angle, angle_between(direction, at.direction));
  }
  return miss;
}

}  // namespace abbe
