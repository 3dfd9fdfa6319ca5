#include "abbe/errors/actual_pose.h"

#include <Eigen/Geometry>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

#include "abbe/geometry/rotation.h"
#include "abbe/machine/coupling.h"

namespace abbe {
namespace {

/// The axis line as displaced by its location errors.
struct AxisLine {
  Eigen::Vector3d direction;
  Eigen::Vector3d centre;
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero();  ///< EA0, EB0, EC0 without the zero position error
  double zero_position = 0;
};

/// What a coefficient of an error is multiplied with; NaN where its state has no factor.
double factor_of(std::size_t state, std::span<const double> factors) {
  if (state == kNoState) return 1;
  return factors.empty() ? std::numeric_limits<double>::quiet_NaN() : factors[state];
}

AxisLine displaced_line(const Axis& axis, const ErrorSet& errors, std::size_t index, std::span<const double> factors) {
  AxisLine line{axis.direction, axis.point};
  for (const LocationError& location : errors.locations) {
    if (location.axis != index) continue;
    const LocationEffect effect = location_effect(axis, location.component);
    const double value = location.value * factor_of(location.state, factors);
    line.zero_position += value * effect.zero_position;
    line.tilt += value * effect.tilt;
    line.centre += value * effect.shift;
  }
  line.direction = rotation_from_error_angles(line.tilt) * axis.direction;
  return line;
}

RigidTransform line_motion(const Axis& axis, const AxisLine& line, double position) {
  const double displacement = axis.sense() * (position + line.zero_position);
  if (axis.kind == AxisKind::linear) return RigidTransform::translate(displacement * line.direction);
  const Eigen::Matrix3d rotation = rotation_about(line.direction, displacement);
  return {rotation, line.centre - rotation * line.centre};
}

bool error_comes_first(const Axis& axis, const Composition& composition) {
  if (composition.order == ErrorOrder::iso) return axis.kind == AxisKind::rotary;
  return composition.order == ErrorOrder::before_motion;
}

Eigen::Vector3d translations(const std::array<double, kComponentCount>& e) { return {e[0], e[1], e[2]}; }
Eigen::Vector3d angles(const std::array<double, kComponentCount>& e) { return {e[3], e[4], e[5]}; }

RigidTransform error_transform(const Axis& axis, const std::array<double, kComponentCount>& e, bool first_order) {
  const Eigen::Matrix3d rotation = first_order ? Eigen::Matrix3d(Eigen::Matrix3d::Identity() + skew(angles(e)))
                                               : rotation_from_error_angles(angles(e));
  return {rotation, axis.point + translations(e) - rotation * axis.point};
}

RigidTransform motion_with_line(const Machine& machine, const ErrorSet& errors, std::size_t index, double position,
                                const AxisLine& line, std::span<const double> factors) {
  const Axis& axis = machine.axes[index];
  const RigidTransform motion = line_motion(axis, line, position);
  const RigidTransform error =
      error_transform(axis, errors.evaluate(index, position, factors), errors.composition.first_order);
  return error_comes_first(axis, errors.composition) ? error * motion : motion * error;
}

/// Velocity field v(x) = linear + angular x x.
struct Twist {
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();

  static Twist translation(const Eigen::Vector3d& direction) { return {Eigen::Vector3d::Zero(), direction}; }
  static Twist rotation(const Eigen::Vector3d& axis, const Eigen::Vector3d& through) {
    return {axis, -axis.cross(through)};
  }
  Twist carried_by(const RigidTransform& t) const {
    const Eigen::Vector3d turned = t.rotation * angular;
    return {turned, t.rotation * linear - turned.cross(t.translation)};
  }
  Twist minus(const Twist& other) const { return {angular - other.angular, linear - other.linear}; }
  Twist plus(const Twist& other, double factor) const {
    return {angular + factor * other.angular, linear + factor * other.linear};
  }
};

/// Derivatives of one axis's displacement by what moves it, as twists in the frame on its bed side.
struct AxisTwists {
  std::array<Twist, kComponentCount> errors;     ///< by EX .. EC
  std::array<Twist, kComponentCount> locations;  ///< by EX0 .. EC0
  Twist position;                                ///< by the command, error motions included
};

AxisTwists twists_of_axis(const Machine& machine, const ErrorSet& errors, std::size_t index, double position,
                          const AxisLine& line, std::span<const double> factors) {
  const Axis& axis = machine.axes[index];
  const RigidTransform motion = line_motion(axis, line, position);
  const std::array<double, kComponentCount> e = errors.evaluate(index, position, factors);
  const RigidTransform error = error_transform(axis, e, false);
  const bool error_first = error_comes_first(axis, errors.composition);

  AxisTwists twists;
  const Eigen::Matrix3d error_axes = error_angle_axes(angles(e));
  for (int k = 0; k < 3; ++k) {
    const std::size_t t = static_cast<std::size_t>(k);
    twists.errors[t] = Twist::translation(Eigen::Vector3d::Unit(k));
    twists.errors[t + 3] = Twist::rotation(error_axes.col(k), axis.point + translations(e));
  }
  const Twist along = axis.kind == AxisKind::linear ? Twist::translation(axis.sense() * line.direction)
                                                    : Twist::rotation(axis.sense() * line.direction, line.centre);
  const Eigen::Matrix3d tilt_axes = error_angle_axes(line.tilt);
  for (int c = 0; c < kComponentCount; ++c) {
    const LocationEffect effect = location_effect(axis, static_cast<Component>(c));
    const Twist shift = Twist::translation(effect.shift);
    const Twist tilt = Twist::rotation(tilt_axes * effect.tilt, line.centre);
    // L M L^-1 changes by the displacement of the line seen before the motion, less the same carried through it.
    twists.locations[static_cast<std::size_t>(c)] = shift.minus(shift.carried_by(motion))
                                                        .plus(tilt.minus(tilt.carried_by(motion)), 1)
                                                        .plus(along, effect.zero_position);
  }
  twists.position = along;
  if (error_first) {
    for (Twist& twist : twists.locations) twist = twist.carried_by(error);
    twists.position = twists.position.carried_by(error);
  } else {
    for (Twist& twist : twists.errors) twist = twist.carried_by(motion);
  }
  for (const ErrorMotion& term : errors.motions) {
    if (term.axis != index) continue;
    twists.position =
        twists.position.plus(twists.errors[static_cast<std::size_t>(term.component)],
                             term.basis.slope(position, term.coefficients) * factor_of(term.state, factors));
  }
  return twists;
}

}  // namespace

RigidTransform actual_motion(const Machine& machine, const ErrorSet& errors, std::size_t axis, double position,
                             std::span<const double> factors) {
  return motion_with_line(machine, errors, axis, position, displaced_line(machine.axes[axis], errors, axis, factors),
                          factors);
}

RigidTransform actual_bed_from_tool(const Machine& machine, const ErrorSet& errors, const std::vector<double>& commands,
                                    std::span<const double> given) {
  assert(commands.size() == machine.axes.size());
  const std::vector<double> factors = state_factors(machine, commands, given);
  const std::vector<double> positions = positions_of_commands(machine, commands);
  RigidTransform bed_from_tool;
  for (std::size_t i = machine.workpiece_axis_count(); i < machine.axes.size(); ++i) {
    bed_from_tool = bed_from_tool * actual_motion(machine, errors, i, positions[i], factors);
  }
  return bed_from_tool *
         RigidTransform::translate(machine.tool_reference + machine.tool_offset + errors.tool_offset_error);
}

RigidTransform actual_bed_from_workpiece(const Machine& machine, const ErrorSet& errors,
                                         const std::vector<double>& commands, std::span<const double> given) {
  assert(commands.size() == machine.axes.size());
  const std::vector<double> factors = state_factors(machine, commands, given);
  const std::vector<double> positions = positions_of_commands(machine, commands);
  RigidTransform bed_from_workpiece;
  for (std::size_t i = machine.workpiece_axis_count(); i-- > 0;) {
    bed_from_workpiece = bed_from_workpiece * actual_motion(machine, errors, i, positions[i], factors);
  }
  return bed_from_workpiece * machine.bed_from_workpiece;
}

RigidTransform actual_workpiece_from_tool(const Machine& machine, const ErrorSet& errors,
                                          const std::vector<double>& commands, std::span<const double> given) {
  assert(!errors.composition.first_order && "a first-order error is not a rotation and has no such inverse");
  return actual_bed_from_workpiece(machine, errors, commands, given).inverse() *
         actual_bed_from_tool(machine, errors, commands, given);
}

PoseStatus tool_deviation(const Machine& machine, const ErrorSet& errors, const std::vector<double>& commands,
                          Deviation& deviation, Eigen::MatrixXd* by_parameters, Eigen::MatrixXd* by_commands,
                          std::span<const double> given) {
  const RigidTransform actual = actual_workpiece_from_tool(machine, errors, commands, given);
  const RigidTransform nominal = nominal_workpiece_from_tool(machine, commands);
  const std::vector<double> positions = positions_of_commands(machine, commands);
  deviation.head<3>() = actual.translation - nominal.translation;
  deviation.tail<3>() = rotation_vector(actual.rotation * nominal.rotation.transpose());

  PoseStatus status = PoseStatus::ok;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    if (!errors.covers(i, positions[i])) status = PoseStatus::out_of_range;
  }
  const std::vector<double> factors = state_factors(machine, commands, given);
  std::vector<std::uint8_t> used(machine.states.size(), 0);
  for (const ErrorMotion& motion : errors.motions) {
    if (motion.state != kNoState) used[motion.state] = 1;
  }
  for (const LocationError& location : errors.locations) {
    if (location.state != kNoState) used[location.state] = 1;
  }
  for (std::size_t j = 0; j < used.size(); ++j) {
    if (used[j] != 0 && !std::isfinite(factors[j])) status = PoseStatus::out_of_range;
  }
  if (!by_parameters && !by_commands) return status;

  const RigidTransform bed_from_workpiece = actual_bed_from_workpiece(machine, errors, commands, given);
  const RigidTransform bed_from_tool = actual_bed_from_tool(machine, errors, commands, given);
  const Eigen::Matrix3d workpiece_from_bed = bed_from_workpiece.rotation.transpose();
  const Eigen::Vector3d point = bed_from_tool.translation;

  if (by_parameters) by_parameters->setZero(6, static_cast<Eigen::Index>(errors.parameter_count()));
  if (by_commands) by_commands->setZero(6, static_cast<Eigen::Index>(machine.axes.size()));
  std::vector<Deviation> by_factor(machine.states.size(), Deviation::Zero());
  const std::size_t workpiece_side = machine.workpiece_axis_count();

  const auto visit = [&](std::size_t axis, const RigidTransform& bed_from_axis) {
    const AxisTwists twists = twists_of_axis(machine, errors, axis, positions[axis],
                                             displaced_line(machine.axes[axis], errors, axis, factors), factors);
    const double sign = axis < workpiece_side ? -1.0 : 1.0;
    const auto seen = [&](const Twist& twist) {
      const Twist in_bed = twist.carried_by(bed_from_axis);
      Deviation column;
      column.head<3>() = sign * (workpiece_from_bed * (in_bed.linear + in_bed.angular.cross(point)));
      column.tail<3>() = sign * (workpiece_from_bed * in_bed.angular);
      return column;
    };
    if (by_commands) by_commands->col(static_cast<Eigen::Index>(axis)) = seen(twists.position);
    Eigen::Index column = 0;
    std::vector<double> functions;
    for (const ErrorMotion& term : errors.motions) {
      const std::size_t size = term.coefficients.size();
      if (term.axis == axis && (by_parameters || term.state != kNoState)) {
        functions.resize(size);
        term.basis.values(positions[axis], term.coefficients, functions);
        const Deviation direction = seen(twists.errors[static_cast<std::size_t>(term.component)]);
        const double factor = factor_of(term.state, factors);
        for (std::size_t k = 0; k < size; ++k) {
          if (by_parameters) {
            by_parameters->col(column + static_cast<Eigen::Index>(k)) = factor * functions[k] * direction;
          }
          if (term.state != kNoState) by_factor[term.state] += term.coefficients[k] * functions[k] * direction;
        }
      }
      column += static_cast<Eigen::Index>(size);
    }
    for (const LocationError& location : errors.locations) {
      if (location.axis == axis && (by_parameters || location.state != kNoState)) {
        const Deviation direction = seen(twists.locations[static_cast<std::size_t>(location.component)]);
        if (by_parameters) by_parameters->col(column) = factor_of(location.state, factors) * direction;
        if (location.state != kNoState) by_factor[location.state] += location.value * direction;
      }
      ++column;
    }
  };
  RigidTransform bed_from_axis;
  for (std::size_t i = workpiece_side; i < machine.axes.size(); ++i) {
    visit(i, bed_from_axis);
    bed_from_axis = bed_from_axis * actual_motion(machine, errors, i, positions[i], factors);
  }
  bed_from_axis = {};
  for (std::size_t i = workpiece_side; i-- > 0;) {
    visit(i, bed_from_axis);
    bed_from_axis = bed_from_axis * actual_motion(machine, errors, i, positions[i], factors);
  }
  if (by_parameters) {
    by_parameters->topRightCorner<3, 3>() = workpiece_from_bed * bed_from_tool.rotation;
  }
  if (by_commands) {
    for (const AxisCoupling& coupling : couplings_in_order(machine)) {
      by_commands->col(static_cast<Eigen::Index>(coupling.of)) +=
          coupling.ratio * by_commands->col(static_cast<Eigen::Index>(coupling.axis));
    }
  }
  for (std::size_t j = 0; by_commands && j < used.size(); ++j) {
    if (used[j] == 0 || !depends_on_commands(machine, j)) continue;
    std::vector<double> slopes;
    state_factor(machine, j, commands, given, &slopes);
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      by_commands->col(static_cast<Eigen::Index>(i)) += slopes[i] * by_factor[j];
    }
  }
  return status;
}

}  // namespace abbe
