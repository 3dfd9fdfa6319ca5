#include "abbe/machine/machine_check.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string_view>
#include <utility>

#include "abbe/geometry/rotation.h"
#include "abbe/machine/coupling.h"

namespace abbe {
namespace {

constexpr double kUnitTolerance = 1e-9;
constexpr double kDependentSine = 1e-3;  // sine of an angle: directions count as the same
// Sine and cosine keep their digits up to here; a travel beyond it, or of more than 10 km, is a wrong unit.
constexpr double kLargestAngle = 20000;   // rad
constexpr double kLargestPosition = 1e7;  // mm

/// What files of readings have besides commands, states and what is measured.
constexpr std::string_view kReadingColumns[] = {"time",      "point", "item",   "station",
                                                "reflector", "setup", "target", "direction"};

std::string ten_digits(double value) { return fmt::format("{:.10g}", value); }

std::string vector_in_ten_digits(const Eigen::Vector3d& v) {
  return "(" + ten_digits(v.x()) + ", " + ten_digits(v.y()) + ", " + ten_digits(v.z()) + ")";
}

class Checker {
 public:
  explicit Checker(const Machine& machine) : machine_(machine) {}

  std::vector<MachineProblem> check() {
    if (machine_.axes.empty()) report("", "axes", "a machine needs at least one axis");
    bool tool_side = false;
    if (machine_.axes.size() > kMaxAxes) report("", "axes", "more than " + std::to_string(kMaxAxes) + " axes");
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
      const Axis& axis = machine_.axes[i];
      check_axis(axis);
      for (std::size_t k = 0; k < i; ++k) {
        if (machine_.axes[k].name == axis.name) report(axis.name, "name", "is used twice; number the axes: C1, C2");
      }
      if (axis.side == ChainSide::tool) tool_side = true;
      if (axis.side == ChainSide::workpiece && tool_side) {
        report(axis.name, "side",
               "carries the workpiece but follows an axis that carries the tool; "
               "axes stand in chain order from workpiece to tool");
      }
    }
    check_unit("", "tool_direction", machine_.tool_direction);
    check_finite("", "tool_reference", machine_.tool_reference);
    check_finite("", "tool_offset", machine_.tool_offset);
    check_frame();
    check_couplings();
    check_states();
    return problems_;
  }

 private:
  void report(const std::string& axis, const std::string& field, const std::string& message) {
    problems_.push_back({axis, field, message});
  }

  bool check_finite(const std::string& axis, const std::string& field, const Eigen::Vector3d& v) {
    if (v.allFinite()) return true;
    report(axis, field, vector_in_ten_digits(v) + " is not finite");
    return false;
  }

  void check_unit(const std::string& axis, const std::string& field, const Eigen::Vector3d& v) {
    if (!check_finite(axis, field, v)) return;
    const double length = v.stableNorm();
    if (std::abs(length - 1) > kUnitTolerance) {
      report(axis, field, vector_in_ten_digits(v) + " has length " + ten_digits(length) + ", must be 1");
    }
  }

  void check_name(const Axis& axis) {
    AxisKind kind;
    bool sound = !axis.name.empty() && axis.name.size() <= 3 && axis_kind_from_letter(axis.name[0], kind);
    for (std::size_t i = 1; i < axis.name.size(); ++i) {
      sound = sound && axis.name[i] >= (i == 1 ? '1' : '0') && axis.name[i] <= '9';
    }
    if (!sound) {
      report(axis.name, "name",
             "'" + axis.name + "' is not an axis name; expected an ISO 841 letter and optional number: X, C2");
    } else if (kind != axis.kind) {
      report(axis.name, "kind",
             fmt::format("the letter stands for a {} axis", kind == AxisKind::linear ? "linear" : "rotary"));
    }
  }

  void check_size(const Axis& axis) {
    const bool linear = axis.kind == AxisKind::linear;
    const double largest = std::max(std::abs(axis.travel_min), std::abs(axis.travel_max));
    if (largest <= (linear ? kLargestPosition : kLargestAngle)) return;
    report(axis.name, "travel",
           linear ? fmt::format("reaches {:g} mm; a machine has less than {:g} mm", largest, kLargestPosition)
                  : fmt::format("reaches {:g} rad, more than {:g}; mark a rotary axis without limits as endless",
                                largest, kLargestAngle));
  }

  void check_axis(const Axis& axis) {
    check_name(axis);
    check_unit(axis.name, "direction", axis.direction);
    check_finite(axis.name, "point", axis.point);
    if (!std::isfinite(axis.travel_min) || !std::isfinite(axis.travel_max)) {
      report(axis.name, "travel", "limits are not finite; mark a rotary axis without limits as endless");
    } else if (axis.travel_min > axis.travel_max) {
      report(axis.name, "travel",
             "minimum " + ten_digits(axis.travel_min) + " exceeds maximum " + ten_digits(axis.travel_max) +
                 (axis.kind == AxisKind::linear ? " (mm)" : " (rad)"));
    } else {
      check_size(axis);
    }
    if (axis.endless && axis.kind == AxisKind::linear)
      report(axis.name, "endless", "only a rotary axis can be endless");
    if (axis.primed && axis.side == ChainSide::tool) {
      report(axis.name, "primed", "a prime marks an axis that carries the workpiece, but this one carries the tool");
    }
  }

  void check_frame() {
    const RigidTransform& frame = machine_.bed_from_workpiece;
    check_finite("", "bed_from_workpiece", frame.translation);
    const Eigen::Matrix3d& r = frame.rotation;
    if (!r.allFinite()) {
      report("", "bed_from_workpiece", "rotation is not finite");
    } else if ((r.transpose() * r - Eigen::Matrix3d::Identity()).norm() > kUnitTolerance || r.determinant() < 0) {
      report("", "bed_from_workpiece",
             "is not a rotation: its axes are not unit vectors at right angles, right-handed");
    }
  }

  void check_couplings() {
    const std::size_t axes = machine_.axes.size();
    if (axes > kMaxAxes) return;
    const std::size_t before = problems_.size();
    for (std::size_t k = 0; k < machine_.couplings.size(); ++k) {
      const AxisCoupling& coupling = machine_.couplings[k];
      if (coupling.axis >= axes || coupling.of >= axes) {
        report("", "couplings", "name an axis that does not exist");
        continue;
      }
      check_coupling(coupling);
      for (std::size_t other = 0; other < k; ++other) {
        if (machine_.couplings[other].axis != coupling.axis || machine_.couplings[other].of != coupling.of) continue;
        report(machine_.axes[coupling.axis].name, "coupled",
               "is coupled to " + machine_.axes[coupling.of].name + " twice");
      }
    }
    if (problems_.size() != before) return;
    const CouplingOrder order = coupling_order(machine_);
    if (order.count < axes) report_cycle(order);
    for (std::size_t i = 0; i < axes && order.count == axes; ++i) {
      if (is_coupled(machine_, i) && !machine_.axes[i].endless) check_positions(i);
    }
  }

  void check_coupling(const AxisCoupling& coupling) {
    const Axis &axis = machine_.axes[coupling.axis], &of = machine_.axes[coupling.of];
    const auto problem = [&](const std::string& message) { report(axis.name, "coupled", message); };
    if (coupling.axis == coupling.of) problem("is coupled to itself");
    if (!std::isfinite(coupling.ratio) || coupling.ratio == 0) {
      problem("the ratio to " + of.name + " is " + ten_digits(coupling.ratio) + "; expected a number other than 0");
    }
    if (axis.side != of.side) {
      problem(fmt::format("carries the {}, but {}, to which it is coupled, the {}: no drive goes through the bed",
                          axis.side == ChainSide::tool ? "tool" : "workpiece", of.name,
                          of.side == ChainSide::tool ? "tool" : "workpiece"));
    }
    if (of.endless) {
      problem(of.name + ", to which it is coupled, is endless: its position would have no limits");
    }
    if (axis.setting && !of.setting) {
      problem(of.name + ", to which it is coupled, is no setting axis: it would not stay where it is set");
    }
  }

  void report_cycle(const CouplingOrder& order) {
    std::string names;
    std::size_t first = Machine::npos;
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
      const auto* const end = order.axis.data() + order.count;
      if (std::find(order.axis.data(), end, i) != end) continue;
      if (first == Machine::npos) first = i;
      names += (names.empty() ? "" : ", ") + machine_.axes[i].name;
    }
    report(machine_.axes[first].name, "coupled",
           "the couplings go round: each of " + names + " needs the command of another one of them");
  }

  void check_positions(std::size_t i) {
    const PositionLimits limits = position_limits(machine_, i);
    const bool linear = machine_.axes[i].kind == AxisKind::linear;
    const double largest = std::max(std::abs(limits.from), std::abs(limits.to));
    if (largest <= (linear ? kLargestPosition : kLargestAngle)) return;
    report(machine_.axes[i].name, "coupled",
           fmt::format("moves it up to {:g} {}; check ratios and travels", largest, linear ? "mm" : "rad"));
  }

  void check_states() {
    check_finite("", "gravity", machine_.gravity);
    if (machine_.states.size() > kMaxStates) report("", "states", fmt::format("more than {} states", kMaxStates));
    for (std::size_t i = 0; i < machine_.states.size(); ++i) {
      const MachineState& state = machine_.states[i];
      state_ = state.name;
      const bool sound = !state.name.empty() && std::all_of(state.name.begin(), state.name.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
      });
      if (!sound) report_state("name", "must be letters, digits and _");
      if (machine_.find_axis(state.name) != Machine::npos) report_state("name", "is the name of an axis");
      const bool reserved =
          std::find(std::begin(kReadingColumns), std::end(kReadingColumns), state.name) != std::end(kReadingColumns);
      if (reserved) report_state("name", "is the name of a column of readings");
      if (find_state(machine_, state.name) != i) report_state("name", "is used twice");
      if (!std::isfinite(state.reference)) report_state("reference", "is not finite");
      check_state(state);
    }
  }

  void check_state(const MachineState& state) {
    const auto is = [&](std::size_t index, StateKind kind) {
      return index < machine_.states.size() && machine_.states[index].kind == kind;
    };
    switch (state.kind) {
      case StateKind::lag:
        if (!is(state.first, StateKind::measured)) report_state("of", "is not a measured state");
        if (!(state.time_constant > 0) || !std::isfinite(state.time_constant)) {
          report_state("time_constant", "is not above 0 s");
        }
        [[fallthrough]];
      case StateKind::measured:
        if (std::find(std::begin(kStateUnits), std::end(kStateUnits), state.unit) == std::end(kStateUnits)) {
          report_state("unit", "'" + state.unit + "' is not a unit of states: degC, K, Nm, N, kg, rpm, s, 1");
        }
        break;
      case StateKind::axis:
      case StateKind::approach:
        if (state.axis >= machine_.axes.size()) report_state("axis", "is not an axis of this machine");
        break;
      case StateKind::gravity:
        check_loads(state);
        break;
      case StateKind::product:
        for (const std::size_t factor : {state.first, state.second}) {
          if (factor >= machine_.states.size() || is(factor, StateKind::product)) {
            report_state("of", "does not name two states that are not products themselves");
          }
        }
        break;
    }
  }

  void check_loads(const MachineState& state) {
    if (state.axis >= machine_.axes.size()) {
      report_state("about", "is not an axis of this machine");
      return;
    }
    if (state.loads.empty()) report_state("load", "a torque of gravity needs at least one load");
    const ChainSide side = machine_.axes[state.axis].side;
    for (const GravityLoad& load : state.loads) {
      const std::size_t by = load.carried_by;
      // Axes stand in chain order: away from the bed on the side of the tool, towards it on that of the workpiece.
      const bool carried = by < machine_.axes.size() && machine_.axes[by].side == side &&
                           (side == ChainSide::tool ? by >= state.axis : by <= state.axis);
      if (!carried) {
        report_state("load", fmt::format("is not carried by {} or by an axis that {} carries",
                                         machine_.axes[state.axis].name, machine_.axes[state.axis].name));
      }
      if (!(load.mass_kg > 0) || !std::isfinite(load.mass_kg)) report_state("load", "has no mass above 0 kg");
      if (!load.point.allFinite()) report_state("load", "its point is not finite");
    }
  }

  void report_state(const std::string& field, const std::string& message) {
    report("", "state." + state_ + "." + field, message);
  }

  const Machine& machine_;
  std::string state_;  ///< name of the one that is looked at
  std::vector<MachineProblem> problems_;
};

/// Directions of all axes as the workpiece sees them, in chain order.
using ChainDirections = std::vector<Eigen::Vector3d>;

/// With the rotary axes at zero and at some places of their travels that have nothing in common, so that what depends
/// on each other there does so everywhere.
std::vector<ChainDirections> directions_at_some_poses(const Machine& machine) {
  constexpr int kPoses = 4;
  std::vector<ChainDirections> poses;
  for (int pose = 0; pose < kPoses; ++pose) {
    ChainDirections directions;
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    double share = 0.31 * pose;
    for (const Axis& axis : machine.axes) {
      directions.emplace_back(turn * axis.direction);
      if (axis.kind == AxisKind::linear || pose == 0) continue;
      share = std::fmod(share + std::numbers::phi, 1.0);
      const double least = axis.endless ? 0 : axis.travel_min, most = axis.endless ? 2 : axis.travel_max;
      turn *= rotation_about(axis.direction, least + share * (most - least));
    }
    poses.push_back(std::move(directions));
  }
  return poses;
}

}  // namespace

std::string MachineProblem::text() const {
  return axis.empty() ? field + ": " + message : "axis " + axis + ": " + field + ": " + message;
}

std::vector<MachineProblem> find_problems(const Machine& machine) { return Checker(machine).check(); }

std::vector<std::string> find_remarks(const Machine& machine) {
  std::vector<std::size_t> linear;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (machine.axes[i].kind == AxisKind::linear) linear.push_back(i);
  }
  const std::vector<ChainDirections> poses = directions_at_some_poses(machine);
  const auto in_line = [&poses](std::size_t i, std::size_t k) {
    return std::all_of(poses.begin(), poses.end(),
                       [&](const ChainDirections& d) { return d[i].cross(d[k]).norm() < kDependentSine; });
  };
  const auto in_plane = [&poses](std::size_t i, std::size_t k, std::size_t m) {
    return std::all_of(poses.begin(), poses.end(),
                       [&](const ChainDirections& d) { return std::abs(d[i].cross(d[k]).dot(d[m])) < kDependentSine; });
  };
  const auto name = [&machine](std::size_t i) { return machine.axes[i].name; };
  std::vector<std::string> remarks;
  for (std::size_t i = 0; i < linear.size(); ++i) {
    for (std::size_t k = i + 1; k < linear.size(); ++k) {
      const std::size_t one = linear[i], two = linear[k];
      if (in_line(one, two)) {
        remarks.push_back(fmt::format(
            "{} and {} move along the same line: a pose leaves open how far each of them moves", name(one), name(two)));
        continue;
      }
      for (std::size_t m = k + 1; m < linear.size(); ++m) {
        const std::size_t three = linear[m];
        if (in_line(one, three) || in_line(two, three) || !in_plane(one, two, three)) continue;
        remarks.push_back(fmt::format("{}, {} and {} move in one plane: together they do not reach all places of space",
                                      name(one), name(two), name(three)));
      }
    }
  }
  return remarks;
}

}  // namespace abbe
