#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "abbe/controls/control_table.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/chain.h"

namespace abbe::test {

/// A head B on X and Y, a table C on Z: the table of the manual, page 670.
inline Machine machine_of_the_manual() {
  Machine machine = parse_chain("w C' Z' b X Y B t").machine;
  machine.tool_offset = {0, 0, -120};
  machine.axes[machine.find_axis("B")].point = {0.016, 0, 250.051};
  machine.axes[machine.find_axis("C")].point = {0.016 - 298.923, 200.172, 250.051};
  return machine;
}

/// The same with a nutating axis B in the plane of Y and Z, and reference points of linear axes somewhere else.
inline Machine nutating_machine() {
  Machine machine = machine_of_the_manual();
  machine.axes[machine.find_axis("B")].direction = Eigen::Vector3d(0, 1, 1).normalized();
  machine.axes[machine.find_axis("X")].point = {-200, 30, 400};
  machine.axes[machine.find_axis("Z")].point = {-100, 300, -700};
  return machine;
}

/// A table that turns in its own positive sense, and a tilt of half a turn with it.
inline Machine unprimed_machine() {
  Machine machine = machine_of_the_manual();
  Axis& table = machine.axes[machine.find_axis("C")];
  table.primed = false;
  table.endless = true;
  return machine;
}

inline Machine trunnion_machine() {
  return read_machine(std::string(ABBE_SOURCE_DIR) + "/examples/machines/trunnion-mill.machine.toml");
}

struct DescribedCase {
  std::string name;
  std::function<Machine()> machine;
};
inline std::vector<DescribedCase> described_cases() {
  return {{"trunnion", trunnion_machine},
          {"manual", machine_of_the_manual},
          {"nutating", nutating_machine},
          {"unprimed", unprimed_machine}};
}

/// Range of commands in mm or rad: of an endless axis a turn.
inline std::pair<double, double> range_of(const Axis& axis) {
  return axis.endless ? std::pair(0.0, kTurn) : std::pair(axis.travel_min, axis.travel_max);
}

inline ErrorMotion some_motion(const Machine& machine, std::size_t axis, Component component, double size) {
  ErrorMotion motion;
  motion.axis = axis;
  motion.component = component;
  const auto [from, to] = range_of(machine.axes[axis]);
  motion.basis = {.kind = machine.axes[axis].endless ? BasisKind::fourier : BasisKind::legendre,
                  .order = machine.axes[axis].endless ? 1 : 2,
                  .from = from,
                  .to = to,
                  .period = machine.axes[axis].endless ? kTurn : 0};
  motion.coefficients = {0.3 * size, size, -0.6 * size};
  return motion;
}

/// All error motions, 6 per axis, and all location errors that shift or tilt a line or a zero: of different sizes.
inline ErrorSet all_errors(const Machine& machine) {
  ErrorSet errors;
  double size = 1;
  const auto next = [&](Component component, double mm, double rad) {
    size = -1.07 * size;
    if (std::abs(size) > 2) size /= 4;
    return size * (is_rotation(component) ? rad : mm);
  };
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    for (int c = 0; c < kComponentCount; ++c) {
      const auto component = static_cast<Component>(c);
      errors.motions.push_back(some_motion(machine, i, component, next(component, 5e-3, 2e-5)));
      if (!location_error_is_valid(machine.axes[i], component)) continue;
      errors.locations.push_back({.axis = i, .component = component, .value = next(component, 0.02, 6e-5)});
    }
  }
  return errors;
}

inline ControlTableRequest comp_request(const Machine& machine, const ErrorSet& errors) {
  ControlTableRequest request;
  request.format = "heidenhain-kinematics-comp";
  request.machine = machine;
  request.errors = errors;
  request.positions = 3;
  return request;
}

inline std::vector<std::vector<double>> poses_within(const Machine& machine, std::size_t count) {
  std::mt19937_64 generator(20);
  std::vector<std::vector<double>> poses;
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double> pose;
    for (const Axis& axis : machine.axes) {
      const auto [from, to] = range_of(axis);
      const double part = static_cast<double>(generator() >> 11) * 0x1p-53;
      pose.push_back(from + (0.02 + 0.96 * part) * (to - from));
    }
    poses.push_back(std::move(pose));
  }
  return poses;
}

}  // namespace abbe::test
