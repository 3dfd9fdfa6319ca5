#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "abbe/compensate/program/errors_for_test.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/inverse_kinematics.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe::test {

struct ArmWithErrors {
  std::string name;
  Machine machine;
  ErrorSet errors;
  double size = 0;  ///< mm, greatest reach of the tool from the first axis, roughly
};

/// An arm without three neighbouring axes that meet or are parallel.
inline Machine arm_of_no_kind() {
  Machine m = arm_of_lines({{0, 0, 1}, {0.1, 1, 0}, {0, 1, 0.2}, {1, 0.1, 0}, {0, 1, -0.1}, {1, 0, 0.3}},
                           {{0, 0, 0}, {60, 0, 350}, {70, 40, 800}, {110, 20, 860}, {520, 30, 870}, {560, -40, 860}},
                           {690, -20, 900});
  m.name = "arm of no kind";
  return m;
}

inline Machine on_a_rail(const Machine& arm) {
  Machine m = arm;
  Axis rail;
  rail.name = "Y";
  rail.kind = AxisKind::linear;
  rail.side = ChainSide::tool;
  rail.direction = Eigen::Vector3d::UnitY();
  rail.travel_min = -1000;
  rail.travel_max = 1000;
  m.axes.insert(m.axes.begin(), rail);
  m.name = arm.name + " on a rail";
  return m;
}

/// Location errors and errors once and twice per turn of every rotary axis; together they displace the tool by the
/// given root mean square over travel. Where `compliance` is true, half of that is deflection under gravity: a
/// state per rotary axis, the torque of the links beyond it and of a payload, about its own line.
inline ErrorSet errors_of_arm(Machine& machine, double rms_mm, bool compliance, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  const auto rms_of = [&](const ErrorSet& errors) {
    double square = 0;
    for (int k = 0; k < 300; ++k) {
      Deviation deviation;
      tool_deviation(machine, errors, random_commands(machine, generator), deviation);
      square += deviation.head<3>().squaredNorm() / 300;
    }
    return std::sqrt(square);
  };
  const auto scale = [](ErrorSet& errors, double factor) {
    std::vector<double> parameters = errors.parameters();
    for (double& value : parameters) value *= factor;
    errors.set_parameters(parameters);
  };
  ErrorSet errors;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    if (machine.axes[axis].kind != AxisKind::rotary) continue;
    for (const Component component :
         {Component::X, Component::Y, Component::Z, Component::A, Component::B, Component::C}) {
      const double size = is_rotation(component) ? 1 : 500;
      errors.locations.push_back({.axis = axis, .component = component, .value = size * normal(generator)});
      ErrorMotion motion;
      motion.axis = axis;
      motion.component = component;
      motion.basis = {.kind = BasisKind::fourier, .order = 2, .from = -8, .to = 8, .period = kTurn};
      for (int i = 0; i < 5; ++i) motion.coefficients.push_back(i == 0 ? 0 : 0.1 * size * normal(generator));
      errors.motions.push_back(motion);
    }
  }
  // The sizes above are in units of 1 rad and 500 mm: small first, so that they add up as small errors do.
  scale(errors, 1e-5);
  scale(errors, (compliance ? std::sqrt(0.5) : 1) * rms_mm / rms_of(errors));
  if (!compliance) return errors;
  ErrorSet soft;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    if (machine.axes[axis].kind != AxisKind::rotary) continue;
    MachineState state{.name = "torque" + std::to_string(axis), .kind = StateKind::gravity};
    state.axis = axis;
    const std::size_t last = machine.axes.size() - 1;
    for (std::size_t link = axis; link <= last; ++link) {
      const Eigen::Vector3d end = link == last ? machine.tool_reference : machine.axes[link + 1].point;
      state.loads.push_back({link, 6.0, 0.5 * (machine.axes[link].point + end) + Eigen::Vector3d(5, -8, 3)});
    }
    state.loads.push_back({last, 3.0, machine.tool_reference});
    machine.states.push_back(state);
    for (const Component component : {Component::A, Component::B, Component::C}) {
      const double along = std::abs(machine.axes[axis].direction[static_cast<int>(component) - 3]);
      const double softness = 0.3 + along;  // bearings give less than the drive
      soft.locations.push_back(
          {.axis = axis, .component = component, .value = 1e-8 * softness, .state = machine.states.size() - 1});
    }
  }
  scale(soft, std::sqrt(0.5) * rms_mm / rms_of(soft));
  errors.locations.insert(errors.locations.end(), soft.locations.begin(), soft.locations.end());
  return errors;
}

/// Spherical wrist, three parallel axes, no special axes, seven axes, a rail; 0.1 to 2 mm, with and without compliance.
inline std::vector<ArmWithErrors> arms_with_errors() {
  std::vector<ArmWithErrors> arms;
  const std::vector<std::pair<Machine, double>> machines = {{jointed_arm(), 800},
                                                            {parallel_axes_arm(), 1100},
                                                            {arm_of_no_kind(), 1100},
                                                            {seven_axis_arm(), 1100},
                                                            {on_a_rail(jointed_arm()), 800}};
  std::uint64_t seed = 1;
  for (const auto& [machine, size] : machines) {
    for (const double rms_mm : {0.1, 0.5, 2.0}) {
      for (const bool compliance : {false, true}) {
        ArmWithErrors arm{"", machine, {}, size};
        arm.errors = errors_of_arm(arm.machine, rms_mm, compliance, seed++);
        arm.name = machine.name + (compliance ? ", compliant, " : ", ") + std::to_string(rms_mm).substr(0, 3) + " mm";
        arms.push_back(std::move(arm));
      }
    }
  }
  return arms;
}

/// InverseSolution::singular_margin of the solution at these commands; 0 where that is not found.
inline double margin_at(const InverseKinematics& inverse, const std::vector<double>& commands) {
  const RigidTransform pose = nominal_workpiece_from_tool(inverse.machine(), commands);
  const InverseResult result = inverse.solve(PoseTarget::at(pose), commands);
  return result.solutions.empty() ? 0 : result.solutions.front().singular_margin;
}

}  // namespace abbe::test
