#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/rotation.h"
#include "abbe/identify/identify.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/instruments/tracker_observations.h"
#include "abbe/instruments/tracker_simulation.h"

namespace abbe::test {

/// The same machine in another base frame: everything that is given in the machine frame, moved.
inline Machine moved(Machine machine, const RigidTransform& to) {
  for (Axis& axis : machine.axes) {
    axis.direction = (to.rotation * axis.direction).normalized();
    axis.point = to * axis.point;
  }
  machine.bed_from_workpiece = to * machine.bed_from_workpiece;
  machine.tool_reference = to * machine.tool_reference;
  machine.tool_offset = to.rotation * machine.tool_offset;
  machine.tool_direction = to.rotation * machine.tool_direction;
  return machine;
}

inline ErrorSet all_locations(const Machine& machine) {
  ErrorSet errors;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis)
    for (int component = 0; component < kComponentCount; ++component)
      if (location_error_is_valid(machine.axes[axis], static_cast<Component>(component)))
        errors.locations.push_back({axis, static_cast<Component>(component), 0, 0});
  return errors;
}

/// Seven rotary axes in the manner of a KUKA LBR iiwa 7.
inline Machine seven_axis_arm() {
  Machine machine;
  const double heights[7] = {0, 340, 540, 740, 940, 1140, 1200};
  for (int i = 0; i < 7; ++i) {
    Axis axis;
    const bool roll = i % 2 == 0;
    axis.name = std::string(roll ? "C" : "B") + std::to_string(i + 1);
    axis.kind = AxisKind::rotary;
    axis.direction = roll ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(0, i == 3 ? -1 : 1, 0);
    axis.point = {0, 0, heights[i]};
    axis.travel_min = -2;
    axis.travel_max = 2;
    machine.axes.push_back(axis);
  }
  machine.tool_reference = {0, 0, 1266};
  return machine;
}

}  // namespace abbe::test
