#include "abbe/machine/state.h"

#include <Eigen/Geometry>
#include <cassert>
#include <cmath>
#include <limits>

#include "abbe/machine/coupling.h"
#include "abbe/machine/first_order_lag.h"
#include "abbe/machine/machine.h"

namespace abbe {
namespace {

/// An axis line in the machine frame at a pose.
struct LineAtPose {
  Eigen::Vector3d direction, point;
};

/// Torque about the line of one axis, N m; commands of the axes between the bed and the loads move both.
///
/// With u the line's direction, c a point on it, p a mass m and g: sum of u . ((p - c) x m g). A rotation w of an axis
/// nearer to the bed turns the line with the masses, which is a rotation -w of g alone; an axis from the line onwards
/// moves masses only.
double torque(const Machine& machine, const MachineState& state, std::span<const double> positions,
              std::vector<double>* by_positions) {
  const bool on_workpiece = machine.axes[state.axis].side == ChainSide::workpiece;
  const std::size_t side = machine.workpiece_axis_count();
  std::vector<std::size_t> outwards;  // from the bed
  if (on_workpiece) {
    for (std::size_t i = side; i-- > 0;) outwards.push_back(i);
  } else {
    for (std::size_t i = side; i < machine.axes.size(); ++i) outwards.push_back(i);
  }
  std::vector<LineAtPose> lines(machine.axes.size());
  std::vector<Eigen::Vector3d> places(state.loads.size(), Eigen::Vector3d::Zero());
  std::vector<std::size_t> order(machine.axes.size(), 0);
  RigidTransform bed_from_carried;
  for (std::size_t n = 0; n < outwards.size(); ++n) {
    const std::size_t i = outwards[n];
    const Axis& axis = machine.axes[i];
    order[i] = n;
    lines[i] = {bed_from_carried.rotation * axis.direction, bed_from_carried * axis.point};
    bed_from_carried = bed_from_carried * nominal_motion(axis, positions[i]);
    for (std::size_t m = 0; m < state.loads.size(); ++m) {
      if (state.loads[m].carried_by == i) places[m] = bed_from_carried * state.loads[m].point;
    }
  }
  const LineAtPose& about = lines[state.axis];
  double sum = 0;
  if (by_positions) by_positions->assign(machine.axes.size(), 0.0);
  for (std::size_t m = 0; m < state.loads.size(); ++m) {
    const GravityLoad& load = state.loads[m];
    const Eigen::Vector3d weight = 1e-3 * load.mass_kg * machine.gravity;  // 1e-3: arms are in mm
    const Eigen::Vector3d arm = places[m] - about.point;
    sum += about.direction.dot(arm.cross(weight));
    if (!by_positions) continue;
    for (const std::size_t i : outwards) {
      if (order[i] > order[load.carried_by]) continue;
      const Axis& axis = machine.axes[i];
      const Eigen::Vector3d moves = axis.sense() * lines[i].direction;
      double& slope = (*by_positions)[i];
      if (order[i] < order[state.axis]) {
        if (axis.kind == AxisKind::rotary) slope -= about.direction.dot(arm.cross(moves.cross(weight)));
      } else if (axis.kind == AxisKind::rotary) {
        slope += about.direction.dot(moves.cross(places[m] - lines[i].point).cross(weight));
      } else {
        slope += about.direction.dot(moves.cross(weight));
      }
    }
  }
  return sum;
}

/// Factor of a state, and its derivatives by the positions of the axes.
double factor_at_positions(const Machine& machine, std::size_t state, std::span<const double> positions,
                           std::span<const double> given, std::vector<double>* by_positions) {
  assert(positions.size() == machine.axes.size() && (given.empty() || given.size() == machine.states.size()));
  const MachineState& one = machine.states[state];
  if (by_positions) by_positions->assign(machine.axes.size(), 0.0);
  const double value = given.empty() ? std::numeric_limits<double>::quiet_NaN() : given[state];
  switch (one.kind) {
    case StateKind::measured:
    case StateKind::lag:
      return value - one.reference;
    case StateKind::approach:
      return std::isnan(value) ? 0 : value;
    case StateKind::axis:
      if (by_positions) (*by_positions)[one.axis] = 1;
      return positions[one.axis] - one.reference;
    case StateKind::gravity:
      return torque(machine, one, positions, by_positions);
    case StateKind::product:
      break;
  }
  std::vector<double> by_first, by_second;
  const double first = factor_at_positions(machine, one.first, positions, given, by_positions ? &by_first : nullptr);
  const double second = factor_at_positions(machine, one.second, positions, given, by_positions ? &by_second : nullptr);
  if (by_positions) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      (*by_positions)[i] = by_first[i] * second + first * by_second[i];
    }
  }
  return first * second;
}

std::string written_unit(const std::string& unit) {
  if (unit == "degC") return "K";
  return unit == "Nm" ? "N m" : unit;
}

}  // namespace

const char* state_kind_name(StateKind kind) {
  static constexpr const char* kNames[] = {"measured", "lag", "axis", "approach", "gravity", "product"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string factor_unit(const Machine& machine, std::size_t state) {
  const MachineState& one = machine.states[state];
  switch (one.kind) {
    case StateKind::axis:
      return machine.axes[one.axis].kind == AxisKind::linear ? "mm" : "rad";
    case StateKind::approach:
      return "1";
    case StateKind::gravity:
      return "N m";
    case StateKind::product: {
      const std::string first = factor_unit(machine, one.first), second = factor_unit(machine, one.second);
      if (first == "1") return second;
      return second == "1" ? first : first + " " + second;
    }
    default:
      return written_unit(one.unit);
  }
}

std::string state_column(const MachineState& state) {
  return state.unit == "1" ? state.name : state.name + "_" + state.unit;
}

std::size_t find_state(const Machine& machine, std::string_view name) {
  for (std::size_t i = 0; i < machine.states.size(); ++i) {
    if (machine.states[i].name == name) return i;
  }
  return kNoState;
}

bool depends_on_commands(const Machine& machine, std::size_t state) {
  const MachineState& one = machine.states[state];
  if (one.kind == StateKind::product) {
    return depends_on_commands(machine, one.first) || depends_on_commands(machine, one.second);
  }
  return one.kind == StateKind::axis || one.kind == StateKind::gravity;
}

double state_factor(const Machine& machine, std::size_t state, std::span<const double> commands,
                    std::span<const double> given, std::vector<double>* by_commands) {
  if (machine.couplings.empty()) return factor_at_positions(machine, state, commands, given, by_commands);
  const std::vector<double> positions = positions_of_commands(machine, commands);
  const double factor = factor_at_positions(machine, state, positions, given, by_commands);
  if (by_commands) slopes_by_commands(machine, by_commands->data());
  return factor;
}

std::vector<double> state_factors(const Machine& machine, std::span<const double> commands,
                                  std::span<const double> given) {
  std::vector<double> factors;
  for (std::size_t i = 0; i < machine.states.size(); ++i) {
    factors.push_back(state_factor(machine, i, commands, given));
  }
  return factors;
}

std::vector<double> lagged(std::span<const double> time_s, std::span<const double> value, double time_constant_s) {
  assert(time_s.size() == value.size() && time_constant_s > 0);
  std::vector<double> result(value.begin(), value.end());
  if (value.empty()) return result;
  FirstOrderLag lag(time_constant_s, value.front());
  for (std::size_t k = 1; k < value.size(); ++k) result[k] = lag.advance(time_s[k] - time_s[k - 1], value[k]);
  return result;
}

}  // namespace abbe
