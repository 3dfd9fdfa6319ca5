#include "abbe/compensate/program/piece_bound.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/geometry/rotation.h"
#include "abbe/geometry/singular_values.h"
#include "abbe/machine/inverse_plan.h"

namespace abbe {
namespace {

/// Bounds of a vector x(s) of the nominal chain and of its difference e(s) = actual - nominal. `bend` of the difference
/// holds twice the sum of jumps besides, so that max|g''| / 8 + sum|jumps| / 4 is an eighth of it.
struct Majorant {
  double speed = 0, bend = 0;
  double off = 0, off_speed = 0, off_bend = 0;

  void add(double value, double rate, double second) {
    off += value;
    off_speed += rate;
    off_bend += second;
  }

  /// (R - 1) v added, with bounds of R - 1 and its derivatives; v = nominal + difference.
  void turn(double length, double value, double rate, double second) {
    const double v = length + off, v_speed = speed + off_speed, v_bend = bend + off_bend;
    add(value * v, rate * v + value * v_speed, second * v + 2 * rate * v_speed + value * v_bend);
  }
};

/// E - 1 of an axis along s.
struct ErrorAlong {
  ErrorAlong(const AxisErrorBound& e, double speed, double bend)
      : shift(e.shift),
        shift_rate(e.shift_slope * speed),
        shift_second(e.shift_bend * speed * speed + e.shift_slope * bend + 2 * e.shift_jumps * speed),
        turn(e.turn),
        turn_rate(e.turn_slope * speed),
        turn_second(e.turn_bend * speed * speed + e.turn_slope * bend + 2 * e.turn_jumps * speed) {}
  double shift, shift_rate, shift_second;
  double turn, turn_rate, turn_second;
};

/// A rotary axis at q' about a displaced line instead of at q about its own.
void rotate(Majorant& m, double length, double across, double speed, double actual_speed, double offset,
            double offset_speed, double line_turn) {
  // e <- Rot(q) e + [K Rot(q') K' - Rot(q)] (x + e)
  const Majorant before = m;
  m.off_speed += speed * before.off;
  m.off_bend += 2 * speed * before.off_speed + speed * speed * before.off;
  // Along the axis line Rot(q') - Rot(q) is zero: the lever is the distance from the line.
  const double turn = std::min(offset, 2.0), turn_speed = offset_speed + turn * speed;
  const double turn_bend = 2 * speed * offset_speed + offset_speed * offset_speed + turn * speed * speed;
  const double v_speed = before.speed + before.off_speed, v_bend = before.bend + before.off_bend;
  const double v = across + before.off;
  m.add(turn * v, turn_speed * v + turn * v_speed, turn_bend * v + 2 * turn_speed * v_speed + turn * v_bend);
  const double tilt = 2 * line_turn, w = length + before.off;
  m.add(tilt * w, tilt * (actual_speed * w + v_speed),
        tilt * (actual_speed * actual_speed * w + 2 * actual_speed * v_speed + v_bend));
  m.bend = before.bend + 2 * speed * before.speed + speed * speed * across;
  m.speed = before.speed + speed * across;
}

double square(double x) { return x * x; }

}  // namespace

PieceBounder::PieceBounder(const Machine& machine, const ErrorSet& errors, const std::array<std::size_t, 3>& point_axes)
    : machine_(machine), tool_error_(errors.tool_offset_error.norm()), point_axes_(point_axes) {
  std::sort(point_axes_.begin(), point_axes_.end());
  const std::size_t n = machine.axes.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Axis& axis = machine.axes[i];
    AxisModel model(machine, errors, i);
    Eigen::Vector3d tilt = Eigen::Vector3d::Zero(), shift = Eigen::Vector3d::Zero();
    for (const LocationError& location : errors.locations) {
      if (location.axis != i) continue;
      const LocationEffect effect = location_effect(axis, location.component);
      model.zero_position += location.value * effect.zero_position;
      tilt += location.value * effect.tilt;
      shift += location.value * effect.shift;
    }
    model.zero_position = std::abs(model.zero_position);
    model.line_turn = tilt.lpNorm<1>();
    model.line_shift = shift.norm();
    axes_.push_back(std::move(model));
  }
  for (std::size_t i = n; i-- > 0;) {
    if (axes_[i].rotary || (i + 1 < n && !axes_[i + 1].rotary)) continue;
    axes_[i].run_begins = true;
    Eigen::MatrixXd directions(3, 0);
    for (std::size_t k = i + 1; k-- > 0 && !axes_[k].rotary;) {
      axes_[i].run.push_back(k);
      directions.conservativeResize(3, directions.cols() + 1);
      directions.rightCols(1) = machine.axes[k].direction;
      axes_[i].bends = axes_[i].bends || is_point_axis(k);
    }
    // Gershgorin's bound of the largest singular value.
    axes_[i].run_stretch = std::sqrt((directions.transpose() * directions).rowwise().lpNorm<1>().maxCoeff());
  }
  set_point_axes();
}

void PieceBounder::set_point_axes() {
  Eigen::Matrix3d directions;
  for (std::size_t i = 0; i < 3; ++i) {
    if (point_axes_[i] >= axes_.size() || axes_[point_axes_[i]].rotary) return;
    directions.col(static_cast<Eigen::Index>(i)) = machine_.axes[point_axes_[i]].direction;
  }
  for (std::size_t i = point_axes_[0]; i < point_axes_[2]; ++i) {
    if (axes_[i].rotary) return;
  }
  if (std::abs(directions.determinant()) < 1e-6) return;
  const Eigen::Matrix3d normal = directions.transpose() * directions;
  // Gershgorin's bound of 1 / (smallest singular value).
  point_condition_ = std::sqrt(normal.inverse().rowwise().lpNorm<1>().maxCoeff());
  has_point_axes_ = true;
}

void PieceBounder::levers(const double* positions, const Eigen::Vector3d& tool, ChainLevers& result) const {
  Eigen::Vector3d x = machine_.tool_reference + tool;
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

void PieceBounder::pass_rotary(std::size_t i, Passing& at) const {
  const AxisModel& axis = axes_[i];
  const PieceMotion& motion = at.motion;
  const double actual_speed = motion.actual_speed[i];
  const AxisErrorBound error = axis.errors.over(motion.lowest[i], motion.highest[i]);
  const ErrorAlong e(error, actual_speed, 0);
  const double length = at.levers.from_point[i] + at.grown, across = at.levers.from_line[i] + at.grown;
  if (play_.any) {
    at.lag += play_.lag[i] * (across + at.point.off + error.shift_slope + error.turn_slope * length);
    at.lag_turn += play_.lag[i] * (1 + error.turn_slope);
  }
  const double offset = motion.tool_centre ? play_.offset[i] : 0;
  // From the tool: Rot, then E; towards the workpiece: the inverse of E, shift first, then that of Rot.
  if (!axis.tool_side) {
    at.point.add(e.shift, e.shift_rate, e.shift_second);
    at.turn_by_error(e, length);
  }
  rotate(at.point, length, across, at.point_speed(i), actual_speed, at.point_offset(i) + axis.zero_position + offset,
         at.point_offset_speed(i), axis.line_turn);
  at.point.add(2 * axis.line_shift, axis.line_shift * actual_speed, axis.line_shift * square(actual_speed));
  rotate(at.direction, 1, 1, motion.speed[i], actual_speed, motion.offset[i] + axis.zero_position,
         motion.offset_speed[i], axis.line_turn);
  if (axis.tool_side) {
    at.turn_by_error(e, length);
    at.point.add(e.shift, e.shift_rate, e.shift_second);
  }
  at.grown += motion.width[i] * across;
}

void PieceBounder::pass_linear(std::size_t i, Passing& at) const {
  const AxisModel& axis = axes_[i];
  const PieceMotion& motion = at.motion;
  const double actual_speed = motion.actual_speed[i];
  const double own_bend = motion.tool_centre && is_point_axis(i) ? at.bend : 0;
  const AxisErrorBound error = axis.errors.over(motion.lowest[i], motion.highest[i]);
  const ErrorAlong e(error, actual_speed, own_bend);
  if (play_.any) {
    at.lag += play_.lag[i] * (error.shift_slope + error.turn_slope * (at.levers.from_point[i] + at.grown));
    at.lag_turn += play_.lag[i] * error.turn_slope;
  }
  if (axis.tool_side) at.turn_by_error(e, at.levers.from_point[i] + at.grown);
  if (axis.run_begins) {
    // Axes with no rotary one between move the point as one vector.
    double speeds = 0, widths = 0, offsets = 0, offset_speeds = 0, lags = 0;
    for (const std::size_t k : axis.run) {
      speeds += square(at.point_speed(k));
      widths += square(motion.width[k]);
      offsets += square(at.point_offset(k) + axes_[k].zero_position + (motion.tool_centre ? play_.offset[k] : 0));
      lags += square(play_.lag[k]);
      offset_speeds += square(at.point_offset_speed(k));
    }
    const double bend = axis.bends ? axis.run_stretch * at.bend : 0;
    at.point.speed += axis.run_stretch * std::sqrt(speeds);
    at.point.bend += bend;
    at.lag += axis.run_stretch * std::sqrt(lags);
    at.grown += axis.run_stretch * std::sqrt(widths);
    at.point.add(axis.run_stretch * std::sqrt(offsets), axis.run_stretch * std::sqrt(offset_speeds),
                 motion.tool_centre ? 0 : bend);
  }
  const double reach = std::max(std::abs(motion.lowest[i]), std::abs(motion.highest[i])) + axis.zero_position;
  at.point.add(axis.line_turn * reach, axis.line_turn * actual_speed, axis.line_turn * own_bend);
  at.point.add(e.shift, e.shift_rate, e.shift_second);
  if (!axis.tool_side) at.turn_by_error(e, at.levers.from_point[i] + at.grown);
}

PieceBound PieceBounder::bound(const ChainLevers& levers, PieceMotion& motion) const {
  std::array<Stage, kMaxAxes> stages;
  if (!motion.tool_centre && motion.arc_bend > 0) follow_arc(motion);
  if (motion.tool_centre && play_.any) widen_by_play(levers, motion);
  const std::size_t stage_end = motion.tool_centre && has_point_axes_ ? point_axes_[0] + 1 : 0;
  const double bend = stage_end > 0 ? move_point_axes(levers, motion, stages) : motion.arc_bend;
  Passing at{levers, motion, bend, {}, {}};
  at.point.off = tool_error_;
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
