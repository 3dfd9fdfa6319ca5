#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/errors/random_stream.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/machine.h"

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

/// Every location error that the machine can have, at zero.
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

/// One to nine axes, rotary and linear, on both sides of the bed; most of them along X, Y or Z, many parallel.
inline Machine random_chain(std::uint64_t seed) {
  RandomStream random(seed, 1);
  const std::size_t count = 1 + static_cast<std::size_t>(random.uniform() * 9);
  const std::size_t on_workpiece = static_cast<std::size_t>(random.uniform() * static_cast<double>(count + 1)) / 2;
  Machine machine;
  for (std::size_t i = 0; i < count; ++i) {
    Axis axis;
    const bool rotary = random.uniform() < 0.6;
    axis.kind = rotary ? AxisKind::rotary : AxisKind::linear;
    axis.name = (rotary ? "C" : "Z") + std::to_string(i + 1);
    axis.side = i < on_workpiece ? ChainSide::workpiece : ChainSide::tool;
    axis.primed = axis.side == ChainSide::workpiece;
    if (random.uniform() < 0.7)
      axis.direction =
          Eigen::Vector3d::Unit(static_cast<int>(random.uniform() * 3)) * (random.uniform() < 0.5 ? -1 : 1);
    else
      axis.direction = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    for (int k = 0; k < 3; ++k) axis.point[k] = std::round(random.uniform(-5, 5)) * 100;
    axis.travel_min = rotary ? -2 : -300;
    axis.travel_max = rotary ? 2 : 300;
    machine.axes.push_back(axis);
  }
  machine.tool_reference = {100, 50, 900};
  return machine;
}

/// A description of a machine that is off: every coordinate of a point and every turn of an axis by up to so much.
inline Machine misjudged(Machine machine, double length_mm, double angle, std::uint64_t seed) {
  RandomStream random(seed);
  const auto up_to = [&](double most) {
    Eigen::Vector3d result;
    for (int k = 0; k < 3; ++k) result[k] = random.uniform(-1, 1) * most;
    return result;
  };
  for (Axis& axis : machine.axes) {
    axis.direction = rotation_from_vector(up_to(angle)) * axis.direction;
    axis.point += up_to(length_mm);
  }
  machine.tool_reference += up_to(length_mm);
  return machine;
}

}  // namespace abbe::test
