#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/chain_plan.h"
#include "abbe/errors/random_stream.h"
#include "abbe/geometry/rotation.h"

/// Random machines, errors and poses for the tests of ChainPlan.
namespace abbe::chain_cases {

inline Eigen::Vector3d random_vector(RandomStream& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

/// A basis of any kind over [from, to].
inline Basis random_basis(RandomStream& random, double from, double to) {
  Basis basis;
  basis.kind = static_cast<BasisKind>(random.bits() % 7);
  basis.from = from;
  basis.to = to;
  basis.order = static_cast<int>(1 + random.bits() % 6);
  if (random.bits() % 4 == 0) basis.order += 14;
  switch (basis.kind) {
    case BasisKind::fourier:
      basis.period = random.bits() % 2 == 0 ? 2 * std::numbers::pi : 0.7 * (to - from);
      break;
    case BasisKind::bspline:
      basis.periodic = random.bits() % 2 == 0;
      basis.period = 0.8 * (to - from);
      break;
    case BasisKind::table_linear:
    case BasisKind::table_monotone: {
      const bool uniform = random.bits() % 2 == 0;
      const int last = basis.order;
      for (int i = 0; i <= last; ++i) {
        const double shift = uniform || i == 0 || i == last ? 0 : random.uniform(-0.4, 0.4);
        basis.nodes.push_back(from + (to - from) * (i + shift) / last);
      }
      basis.periodic = basis.kind == BasisKind::table_linear && random.bits() % 2 == 0;
      basis.period = 1.1 * (to - from);
      break;
    }
    default:
      break;
  }
  return basis;
}

struct Case {
  Machine machine;
  ErrorSet errors;
};

/// 1 to 7 axes in any order, sense and (every other seed) any direction, on both sides.
/// @param size  of the errors: mm, and 1/100 of it in rad
inline Case random_case(std::uint64_t seed, double size, ErrorOrder order = ErrorOrder::iso) {
  RandomStream random(seed, 7);
  Case c;
  const std::size_t axes = 1 + random.bits() % 7;
  const std::size_t workpiece_side = random.bits() % (axes + 1);
  c.errors.composition.order = order;
  for (std::size_t i = 0; i < axes; ++i) {
    Axis axis;
    axis.name.push_back("XYZABC"[random.bits() % 6]);
    axis.name.append(std::to_string(i + 1));
    axis_kind_from_letter(axis.name[0], axis.kind);
    axis.direction = direction_from_letter(axis.name[0]);
    if (seed % 2 == 0) axis.direction = random_vector(random, 1).normalized();
    axis.side = i < workpiece_side ? ChainSide::workpiece : ChainSide::tool;
    axis.primed = random.bits() % 2 == 0;
    axis.point = random_vector(random, 100);
    const bool rotary = axis.kind == AxisKind::rotary;
    axis.travel_min = rotary ? -7 : -200;
    axis.travel_max = rotary ? 9 : 300;
    for (int k = 0; k < kComponentCount; ++k) {
      const Component component = static_cast<Component>(k);
      const double scale = size * (k < 3 ? 1.0 : 1e-2);
      // Some components have no term, some have several, some of which share a basis with others.
      const std::size_t terms = random.bits() % 3;
      for (std::size_t t = 0; t < terms; ++t) {
        Basis basis = random_basis(random, axis.travel_min, axis.travel_max);
        if (t > 0 && random.bits() % 2 == 0) basis = c.errors.motions.back().basis;
        ErrorMotion motion{i, component, basis, std::vector<double>(basis.size()), {}};
        for (double& value : motion.coefficients) value = random.uniform(-scale, scale);
        c.errors.motions.push_back(motion);
      }
      if (location_error_is_valid(axis, component)) {
        c.errors.locations.push_back({i, component, random.uniform(-scale, scale), 0});
      }
    }
    c.machine.axes.push_back(axis);
  }
  c.machine.tool_reference = random_vector(random, 100);
  c.machine.tool_offset = random_vector(random, 100);
  c.machine.bed_from_workpiece = {rotation_from_vector(random_vector(random, 1)), random_vector(random, 100)};
  c.errors.tool_offset_error = random_vector(random, size);
  return c;
}

/// Adds states of every kind and has errors depend on them: error motions as they are drawn, location errors besides
/// those that are there.
/// @param chance  one of so many error motions gets a state
inline void add_random_states(Case& c, std::uint64_t seed, double size, std::size_t chance = 2) {
  RandomStream random(seed, 11);
  Machine& machine = c.machine;
  machine.gravity = random_vector(random, 10);
  const auto any_axis = [&] { return static_cast<std::size_t>(random.bits() % machine.axes.size()); };
  machine.states.push_back({.name = "ambient", .unit = "degC", .reference = 20});
  machine.states.push_back(
      {.name = "core", .kind = StateKind::lag, .unit = "degC", .reference = 20, .first = 0, .time_constant = 100});
  machine.states.push_back({.name = "side", .kind = StateKind::approach, .axis = any_axis()});
  MachineState ram{.name = "ram", .kind = StateKind::axis, .axis = any_axis()};
  const bool rotary = machine.axes[ram.axis].kind == AxisKind::rotary;
  ram.reference = rotary ? 0.3 : 40;
  machine.states.push_back(ram);
  for (const char* name : {"torque", "sag"}) {
    MachineState torque{.name = name, .kind = StateKind::gravity, .axis = any_axis()};
    const bool tool = machine.axes[torque.axis].side == ChainSide::tool;
    for (std::size_t load = 0; load < 3; ++load) {
      // From the axis outwards, which is up the chain on the side of the tool and down on that of the workpiece.
      const std::size_t span = tool ? machine.axes.size() - torque.axis : torque.axis + 1;
      const std::size_t way = random.bits() % span;
      torque.loads.push_back(
          {tool ? torque.axis + way : torque.axis - way, random.uniform(0.1, 2), random_vector(random, 300)});
    }
    machine.states.push_back(torque);
  }
  machine.states.push_back({.name = "payload", .unit = "kg"});
  const auto product = [&](const char* name, const char* first, const char* second) {
    MachineState state{.name = name, .kind = StateKind::product};
    state.first = find_state(machine, first);
    state.second = find_state(machine, second);
    machine.states.push_back(state);
  };
  product("loaded", "payload", "torque");
  product("bent", "ram", "sag");
  product("square", "ram", "ram");
  const auto any_state = [&] { return static_cast<std::size_t>(random.bits() % machine.states.size()); };
  for (ErrorMotion& motion : c.errors.motions) {
    if (random.bits() % chance == 0) motion.state = any_state();
  }
  const std::vector<LocationError> plain = c.errors.locations;
  for (LocationError location : plain) {
    if (random.bits() % chance != 0) continue;
    location.state = any_state();
    location.value = random.uniform(-size, size) * (is_rotation(location.component) ? 1e-2 : 1.0);
    c.errors.locations.push_back(location);
  }
  // Of the size of an error, whatever the factor is.
  const auto usual_factor = [&](std::size_t state) {
    const std::string unit = factor_unit(machine, state);
    double usual = 1;
    if (unit.find("mm") != std::string::npos) usual *= 100;
    if (machine.states[state].kind == StateKind::product) usual *= 10;
    return usual;
  };
  for (ErrorMotion& motion : c.errors.motions) {
    if (motion.state == kNoState) continue;
    for (double& value : motion.coefficients) value /= usual_factor(motion.state);
  }
  for (LocationError& location : c.errors.locations) {
    if (location.state != kNoState) location.value /= usual_factor(location.state);
  }
}

/// The independent route: from a body to the bed by actual_pose.h; a point of the tool from the gauge point.
inline RigidTransform bed_from_body(const Case& c, const std::vector<double>& positions, Body body,
                                    std::span<const double> given = {}) {
  if (body == Body::workpiece) return actual_bed_from_workpiece(c.machine, c.errors, positions, given);
  if (body == Body::tool) {
    const Eigen::Vector3d offset = c.machine.tool_offset + c.errors.tool_offset_error;
    return actual_bed_from_tool(c.machine, c.errors, positions, given) * RigidTransform::translate(-offset);
  }
  return {};
}

/// Poses and points as structure of arrays, with results.
struct Batch {
  std::vector<std::vector<double>> commands;
  std::array<std::vector<double>, 3> start, seen;
  std::array<std::vector<double>, 9> rotation;
  std::vector<std::uint8_t> covered;
  std::vector<std::vector<double>> states;  ///< [states of the machine] of measured and lag states and approaches
  std::vector<const double*> pointers, state_pointers;

  Batch(const Machine& machine, std::size_t count, RandomStream& random) {
    for (const Axis& axis : machine.axes) {
      std::vector<double>& values = commands.emplace_back(count);
      for (double& value : values) value = random.uniform(axis.travel_min, axis.travel_max);
    }
    for (std::vector<double>& values : start) {
      values.resize(count);
      for (double& value : values) value = random.uniform(-100, 100);
    }
    for (std::vector<double>& values : seen) values.assign(count, -1e300);
    for (std::vector<double>& values : rotation) values.assign(count, -1e300);
    covered.assign(count, 7);
    for (const MachineState& state : machine.states) {
      std::vector<double>& values = states.emplace_back();
      if (state.kind == StateKind::approach) {
        for (std::size_t k = 0; k < count; ++k) values.push_back(static_cast<double>(random.bits() % 3) - 1);
      } else if (is_input(state.kind)) {
        for (std::size_t k = 0; k < count; ++k) values.push_back(state.reference + random.uniform(-3, 3));
      }
    }
  }
  std::size_t count() const { return covered.size(); }
  PositionArrays positions() {
    pointers.clear();
    for (const std::vector<double>& values : commands) pointers.push_back(values.data());
    state_pointers.clear();
    for (const std::vector<double>& values : states) state_pointers.push_back(values.empty() ? nullptr : values.data());
    return {pointers, count(), state_pointers};
  }
  /// As state_factor() takes them.
  std::vector<double> given_at(std::size_t k) const {
    std::vector<double> given;
    for (const std::vector<double>& values : states) given.push_back(values.empty() ? std::nan("") : values[k]);
    return given;
  }
  std::vector<double> positions_of(std::size_t k) const {
    std::vector<double> values;
    for (const std::vector<double>& axis : commands) values.push_back(axis[k]);
    return values;
  }
  ConstPointArrays start_arrays() const { return {start[0].data(), start[1].data(), start[2].data()}; }
  PointArrays seen_arrays() { return {seen[0].data(), seen[1].data(), seen[2].data()}; }
  ConstPointArrays const_seen() const { return {seen[0].data(), seen[1].data(), seen[2].data()}; }
  RotationArrays rotation_arrays() {
    RotationArrays arrays;
    for (std::size_t i = 0; i < 9; ++i) arrays.r[i] = rotation[i].data();
    return arrays;
  }
  Eigen::Vector3d start_point(std::size_t k) const { return {start[0][k], start[1][k], start[2][k]}; }
  Eigen::Vector3d seen_point(std::size_t k) const { return {seen[0][k], seen[1][k], seen[2][k]}; }
  Eigen::Matrix3d rotation_matrix(std::size_t k) const {
    Eigen::Matrix3d m;
    for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = rotation[static_cast<std::size_t>(i)][k];
    return m;
  }
  void transform(const ChainPlan& plan) {
    plan.transform(positions(), start_arrays(), seen_arrays(), rotation_arrays(), covered.data());
  }
};

inline constexpr Body kBodies[] = {Body::bed, Body::workpiece, Body::tool};
inline constexpr ErrorOrder kOrders[] = {ErrorOrder::iso, ErrorOrder::after_motion, ErrorOrder::before_motion};

}  // namespace abbe::chain_cases
