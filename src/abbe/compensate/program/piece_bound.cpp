#include "abbe/compensate/program/piece_bound.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/compensate/program/piece_majorant.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/inverse_plan.h"

namespace abbe {
namespace {

double square(double x) { return x * x; }

}  // namespace

void PieceBounder::levers(const double* positions, const Eigen::Vector3d& tool, ChainLevers& result) const {
  Eigen::Vector3d x = machine_.tool_reference + tool;
  result.tool_error = std::abs(tool_length_share_) * (tool - machine_.tool_offset).norm();
  for (std::size_t i = axes_.size(); i-- > 0;) {
    const Axis& axis = machine_.axes[i];
    const double command = chain_sign(axis) * positions[i];
    const Eigen::Vector3d arm = x - axis.point;
    if (!axes_[i].rotary) {
      x += command * axis.direction;
      result.from_point[i] = axes_[i].tool_side ? arm.norm() : (x - axis.point).norm();
      continue;
    }
    result.from_point[i] = arm.norm();
    const Eigen::Vector3d across = axis.direction.cross(arm);
    result.from_line[i] = across.norm();
    x += std::sin(command) * across + (1 - std::cos(command)) * axis.direction.cross(across);
  }
}

/// Commands of X, Y, Z that keep the functional point on a straight line of the workpiece while the other axes move.
///
/// Between the point seen from the tool side and from the workpiece side, U l(s) closes the gap, U constant: so |l''|
/// is bounded by the second derivatives of both, without a circle. @returns the bound of |l''|
double PieceBounder::move_point_axes(const ChainLevers& levers, PieceMotion& motion,
                                     std::array<Stage, kMaxAxes>& stages) const {
  const std::size_t first = point_axes_[0];
  const auto pass = [&](std::size_t i, Stage& stage, double& grown) {
    if (!axes_[i].rotary) {
      stage.speed += motion.actual_speed[i];
      grown += motion.width[i];
      return;
    }
    const double across = levers.from_line[i] + grown, speed = motion.actual_speed[i];
    stage.bend += 2 * speed * stage.speed + speed * speed * across;
    stage.speed += speed * across;
    grown += motion.width[i] * across;
  };
  Stage tool, work{motion.point_speed, 0};
  double tool_grown = 0, work_grown = motion.point_width;
  for (std::size_t i = axes_.size(); i-- > first;) {
    if (!is_point_axis(i)) pass(i, tool, tool_grown);
  }
  // Seen from the workpiece, the point moves as commanded; stages[i]: after axis i, counted from the tool.
  for (std::size_t i = 0; i < first; ++i) {
    stages[i] = work;
    pass(i, work, work_grown);
  }
  stages[first] = work;
  const double fastest = point_condition_ * (tool.speed + work.speed);
  const double bend = point_condition_ * (tool.bend + work.bend);
  for (const std::size_t i : point_axes_) {
    // Over a piece the mean rate is known; the rate leaves it by no more than half the second derivative.
    const double mean = motion.actual_speed[i];
    motion.actual_speed[i] = std::min(fastest, mean + 0.5 * bend);
    motion.lowest[i] -= 0.125 * bend;
    motion.highest[i] += 0.125 * bend;
    motion.width[i] += 0.125 * bend;
  }
  return bend;
}

/// From the rates and offsets of chords to those of arcs: a rate leaves its mean by no more than half the second
/// derivative, a position its chord by no more than an eighth.
void PieceBounder::follow_arc(PieceMotion& motion) const {
  for (const std::size_t i : point_axes_) {
    if (i >= axes_.size()) continue;
    motion.speed[i] += 0.5 * motion.arc_bend;
    motion.offset_speed[i] += 0.5 * motion.arc_bend;
    motion.offset[i] += 0.125 * motion.arc_bend;
    motion.width[i] += 0.125 * motion.arc_bend;
  }
}

/// In tool centre programs the words are those of commands that are offset by up to half of the reversal values: the
/// point is elsewhere by as much, and goes another way by as much as that offset turns.
void PieceBounder::widen_by_play(const ChainLevers& levers, PieceMotion& motion) const {
  double grown = 0, aside = 0, turning = 0, offset_turn = 0, speed = 0;
  for (std::size_t i = axes_.size(); i-- > 0;) {
    motion.width[i] += play_.offset[i];
    if (axes_[i].rotary) {
      const double across = levers.from_line[i] + grown;
      aside += play_.offset[i] * across;
      grown += motion.width[i] * across;
      offset_turn += play_.offset[i];
      turning += motion.actual_speed[i];
      speed += motion.actual_speed[i] * across;
    } else {
      aside += play_.offset[i];
      grown += motion.width[i];
      speed += motion.actual_speed[i];
    }
  }
  // To second order in the offsets; the factor is for the rest.
  motion.point_speed += 2 * (turning * aside + offset_turn * (speed + motion.point_speed));
  motion.point_width += 4 * aside;
}

/// What is known of the point and of the tool's direction on the way from the tool to the workpiece.
struct PieceBounder::Passing {
  const ChainLevers& levers;
  const PieceMotion& motion;
  double bend;  ///< of the commands of X, Y, Z: nominal ones on an arc, actual ones in tool centre programs
  Majorant point, direction;
  double grown = 0;  ///< how far the point may be from that of the levers
  double lag = 0, lag_turn = 0;
  std::array<BoundAlong, kMaxStates> factors{};  ///< of states
  std::array<LineAlong, kMaxAxes> lines{};

  LineBound line_of(std::size_t i) const {
    const LineAlong& line = lines[i];
    return {line.turn.value, line.turn.rate, line.turn.second + square(line.turn.rate), line.zero_position.second};
  }

  // In tool centre programs the control itself follows the point: the chain is compared with the nominal one at the
  // same commands. The direction is compared with that of the commanded ones in all programs.
  double point_speed(std::size_t i) const { return motion.tool_centre ? motion.actual_speed[i] : motion.speed[i]; }
  double point_offset(std::size_t i) const { return motion.tool_centre ? 0 : motion.offset[i]; }
  double point_offset_speed(std::size_t i) const { return motion.tool_centre ? 0 : motion.offset_speed[i]; }

  void turn_by_error(const ErrorAlong& e, double length) {
    point.turn(length, e.turn, e.turn_rate, e.turn_second);
    direction.turn(1 - std::min(direction.off, 1.0), e.turn, e.turn_rate, e.turn_second);
  }
};

PieceBounder::LineAlong PieceBounder::line_along(const AxisModel& axis, const Passing& at) const {
  LineAlong along{{axis.line.turn}, {axis.line.shift}, {axis.line.zero_position}};
  for (const StateErrors& errors : axis.with_state) {
    const BoundAlong& factor = at.factors[errors.state];
    along.turn.add(product_along(factor, {errors.line.turn}));
    along.shift.add(product_along(factor, {errors.line.shift}));
    along.zero_position.add(product_along(factor, {errors.line.zero_position}));
  }
  return along;
}

/// Error motions of an axis along the piece.
/// @param length  of the point from that about which the angles act, mm
ErrorAlong PieceBounder::error_along(std::size_t i, double bend, Passing& at, double length) const {
  const AxisModel& axis = axes_[i];
  const PieceMotion& motion = at.motion;
  const double speed = motion.actual_speed[i];
  const AxisErrorBound error = axis.errors.over(motion.lowest[i], motion.highest[i]);
  ErrorAlong along(error, speed, bend);
  if (play_.any) {
    at.lag += play_.lag[i] * (error.shift_slope + error.turn_slope * length + (axis.rotary ? at.point.off : 0));
    at.lag_turn += play_.lag[i] * error.turn_slope;
  }
  if (axis.with_state.empty()) return along;
  BoundAlong shifts, angles;
  for (const StateErrors& errors : axis.with_state) {
    const AxisErrorBound unit = errors.motions.over(motion.lowest[i], motion.highest[i]);
    const ErrorAlong one(unit, speed, bend);
    const BoundAlong& factor = at.factors[errors.state];
    shifts.add(product_along(factor, {one.shift, one.shift_rate, one.shift_second, play_.lag[i] * unit.shift_slope}));
    angles.add(product_along(factor, {one.turn, one.turn_rate, one.turn_second, play_.lag[i] * unit.turn_slope}));
  }
  along.add_with_states(shifts, angles);
  at.lag += shifts.lag + angles.lag * length;
  at.lag_turn += angles.lag;
  return along;
}

void PieceBounder::pass_rotary(std::size_t i, Passing& at) const {
  const AxisModel& axis = axes_[i];
  const PieceMotion& motion = at.motion;
  const LineAlong& line = at.lines[i];
  const LineBound bound = at.line_of(i);
  const double zero_position = line.zero_position.value, zero_rate = line.zero_position.rate;
  const double actual_speed = motion.actual_speed[i] + zero_rate;
  const double length = at.levers.from_point[i] + at.grown, across = at.levers.from_line[i] + at.grown;
  const ErrorAlong e = error_along(i, 0, at, length);
  if (play_.any) {
    at.lag += play_.lag[i] * across + line.zero_position.lag * across + 2 * line.turn.lag * length + 2 * line.shift.lag;
    at.lag_turn += play_.lag[i] + line.zero_position.lag + 2 * line.turn.lag;
  }
  const double offset = motion.tool_centre ? play_.offset[i] : 0;
  // From the tool: Rot, then E; towards the workpiece: the inverse of E, shift first, then that of Rot.
  if (!axis.tool_side) {
    at.point.add(e.shift, e.shift_rate, e.shift_second);
    at.turn_by_error(e, length);
  }
  rotate(at.point, length, across, at.point_speed(i), actual_speed, at.point_offset(i) + zero_position + offset,
         at.point_offset_speed(i) + zero_rate, bound);
  shift_line(at.point, line.shift, actual_speed, bound);
  rotate(at.direction, 1, 1, motion.speed[i], actual_speed, motion.offset[i] + zero_position,
         motion.offset_speed[i] + zero_rate, bound);
  if (axis.tool_side) {
    at.turn_by_error(e, length);
    at.point.add(e.shift, e.shift_rate, e.shift_second);
  }
  at.grown += motion.width[i] * across;
}

/// Axes with no rotary one between move the point as one vector.
void PieceBounder::pass_run(const AxisModel& axis, Passing& at) const {
  const PieceMotion& motion = at.motion;
  double speeds = 0, widths = 0, offsets = 0, offset_speeds = 0, offset_seconds = 0, lags = 0;
  for (const std::size_t k : axis.run) {
    const BoundAlong& zero_position = at.lines[k].zero_position;
    speeds += square(at.point_speed(k));
    widths += square(motion.width[k]);
    offsets += square(at.point_offset(k) + zero_position.value + (motion.tool_centre ? play_.offset[k] : 0));
    lags += square(play_.lag[k] + zero_position.lag);
    offset_speeds += square(at.point_offset_speed(k) + zero_position.rate);
    offset_seconds += square(zero_position.second);
  }
  const double bend = axis.bends ? axis.run_stretch * at.bend : 0;
  at.point.speed += axis.run_stretch * std::sqrt(speeds);
  at.point.bend += bend;
  at.lag += axis.run_stretch * std::sqrt(lags);
  at.grown += axis.run_stretch * std::sqrt(widths);
  at.point.add(axis.run_stretch * std::sqrt(offsets), axis.run_stretch * std::sqrt(offset_speeds),
               (motion.tool_centre ? 0 : bend) + axis.run_stretch * std::sqrt(offset_seconds));
}

void PieceBounder::pass_linear(std::size_t i, Passing& at) const {
  const AxisModel& axis = axes_[i];
  const PieceMotion& motion = at.motion;
  const LineAlong& line = at.lines[i];
  const LineBound bound = at.line_of(i);
  const double actual_speed = motion.actual_speed[i] + line.zero_position.rate;
  const double own_bend = own_bend_of(i, at);
  const double length = at.levers.from_point[i] + at.grown;
  const ErrorAlong e = error_along(i, own_bend, at, length);
  if (axis.tool_side) at.turn_by_error(e, at.levers.from_point[i] + at.grown);
  if (axis.run_begins) pass_run(axis, at);
  const double reach = std::max(std::abs(motion.lowest[i]), std::abs(motion.highest[i])) + line.zero_position.value;
  at.point.add(bound.turn * reach, bound.turn * actual_speed, bound.turn * own_bend);
  at.point.add(0, bound.turn_rate * reach,
               bound.turn_second * reach + 2 * bound.turn_rate * actual_speed + bound.turn * bound.offset_second);
  at.lag += line.turn.lag * reach;
  at.point.add(e.shift, e.shift_rate, e.shift_second);
  if (!axis.tool_side) at.turn_by_error(e, at.levers.from_point[i] + at.grown);
}

/// Of the commands of an axis as they are driven: lines, but for X, Y and Z in tool centre programs.
double PieceBounder::own_bend_of(std::size_t i, const Passing& at) const {
  return at.motion.tool_centre && is_point_axis(i) ? at.bend : 0;
}

void PieceBounder::set_states(Passing& at) const {
  if (factors_.any()) {
    CommandsAlong commands{at.motion.lowest, at.motion.highest, at.motion.actual_speed, {}, play_.lag};
    for (std::size_t i = 0; i < axes_.size(); ++i) commands.bend[i] = own_bend_of(i, at);
    factors_.along(commands, at.factors);
  }
  for (std::size_t i = 0; i < axes_.size(); ++i) at.lines[i] = line_along(axes_[i], at);
}

PieceBound PieceBounder::bound(const ChainLevers& levers, PieceMotion& motion) const {
  std::array<Stage, kMaxAxes> stages;
  if (!motion.tool_centre && motion.arc_bend > 0) follow_arc(motion);
  if (motion.tool_centre && play_.any) widen_by_play(levers, motion);
  const std::size_t stage_end = motion.tool_centre && has_point_axes_ ? point_axes_[0] + 1 : 0;
  const double bend = stage_end > 0 ? move_point_axes(levers, motion, stages) : motion.arc_bend;
  Passing at{levers, motion, bend, {}, {}};
  set_states(at);
  at.point.off = tool_error_ + levers.tool_error;
  for (std::size_t i = axes_.size(); i-- > 0;) {
    if (axes_[i].rotary) {
      pass_rotary(i, at);
    } else {
      pass_linear(i, at);
    }
    if (i < stage_end) {
      at.point.speed = std::min(at.point.speed, stages[i].speed);
      at.point.bend = std::min(at.point.bend, stages[i].bend);
    }
  }
  PieceBound result;
  // In tool centre programs the chord itself is not in the chain.
  result.position = 0.125 * (at.point.off_bend + (motion.tool_centre ? motion.arc_bend : 0));
  result.orientation = 0.125 * at.direction.off_bend;
  // The chain as it is turns and stretches by less than a thousandth more than that of the levers.
  const double lag = (motion.tool_centre ? 1 + kOvershootShare : 1.0) * 1.001;
  result.lag = lag * at.lag;
  result.lag_turn = lag * at.lag_turn;
  result.axis_bend = motion.tool_centre ? bend : 0;
  return result;
}

}  // namespace abbe
