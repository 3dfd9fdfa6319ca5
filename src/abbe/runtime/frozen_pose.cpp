#include "abbe/runtime/frozen_pose.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "abbe/runtime/frozen_states.h"

namespace abbe {
namespace {

/// Squares of angles below which the series may end where they do: what is left out is below 1e-18.
constexpr double kSmallSquare = 4e-4;
constexpr double kSmallerSquare = 2.5e-7;

/// Two numbers that the processor treats as one: a point and a direction, or two components of an error motion.
using Pair = double __attribute__((vector_size(16)));

Pair pair_at(const double* place) {
  Pair pair;
  std::memcpy(&pair, place, sizeof pair);
  return pair;
}

/// EX EY, EZ EA, EB EC of one axis.
struct SixErrors {
  Pair xy{}, za{}, bc{};

  void add(double factor, const double* coefficients) {
    xy += factor * pair_at(coefficients);
    za += factor * pair_at(coefficients + 2);
    bc += factor * pair_at(coefficients + 4);
  }
};

void add_chebyshev(const FrozenGroup& group, double position, SixErrors& sum) {
  const double s = group.scale * position + group.shift;
  const double* row = group.coefficients;
  double t = 1, before = s;  // T_0 and T_-1 = T_1
  for (std::size_t k = 0; k < group.functions; ++k, row += 6) {
    sum.add(t, row);
    const double next = 2 * s * t - before;
    before = t;
    t = next;
  }
}

void add_fourier(const FrozenGroup& group, const CosineSine& first, SixErrors& sum) {
  const double* row = group.coefficients;
  sum.add(1, row);
  CosineSine turn = first;
  for (std::size_t k = 1; k + 1 < group.functions; k += 2) {
    row += 6;
    sum.add(turn.c, row);
    row += 6;
    sum.add(turn.s, row);
    turn = turned_on(turn, first);
  }
}

void add_piecewise(const FrozenGroup& group, double position, SixErrors& sum) {
  double q = position;
  if (group.period > 0) q -= group.period * std::floor((q - group.origin) / group.period);
  std::size_t i = 0;
  if (group.per_spacing > 0) {
    const double place = std::floor((q - group.origin) * group.per_spacing);
    i = static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(group.functions - 1)));
  } else {
    const double* after = std::upper_bound(group.nodes, group.nodes + group.functions, q);
    i = after == group.nodes ? 0 : static_cast<std::size_t>(after - group.nodes) - 1;
  }
  const double u = (q - group.nodes[i]) / (group.nodes[i + 1] - group.nodes[i]);
  const double* row = group.coefficients + 24 * i;
  sum.add(1, row);
  sum.add(u, row + 6);
  sum.add(u * u, row + 12);
  sum.add(u * u * u, row + 18);
}

/// Point and direction of the tool side by side: x, y, z of both.
struct PointAndDirection {
  Pair x, y, z;
};

/// A vector that moves points and leaves directions.
PointAndDirection moved(const PointAndDirection& v, const Triple& by) {
  return {v.x + Pair{by.x, 0}, v.y + Pair{by.y, 0}, v.z + Pair{by.z, 0}};
}

/// Rz(EC) Ry(EB) Rx(EA) of vectors, and its inverse.
struct SmallRotation {
  CosineSine a, b, c;

  PointAndDirection of(const PointAndDirection& v) const {
    const Pair y = a.c * v.y - a.s * v.z, z = a.s * v.y + a.c * v.z;
    const Pair x = b.c * v.x + b.s * z;
    return {c.c * x - c.s * y, c.s * x + c.c * y, b.c * z - b.s * v.x};
  }
  PointAndDirection back(const PointAndDirection& v) const {
    const Pair x = c.c * v.x + c.s * v.y, y = c.c * v.y - c.s * v.x;
    const Pair z = b.s * x + b.c * v.z;
    return {b.c * x - b.s * v.z, a.c * y + a.s * z, a.c * z - a.s * y};
  }
};

/// Rotation about a unit direction.
PointAndDirection about(const Triple& u, const CosineSine& turn, const PointAndDirection& v) {
  const Pair along = (1 - turn.c) * (u.x * v.x + u.y * v.y + u.z * v.z);
  const double x = turn.s * u.x, y = turn.s * u.y, z = turn.s * u.z;
  return {turn.c * v.x + (y * v.z - z * v.y) + along * u.x, turn.c * v.y + (z * v.x - x * v.z) + along * u.y,
          turn.c * v.z + (x * v.y - y * v.x) + along * u.z};
}

/// The line of an axis with so much of its location errors.
struct Line {
  Triple direction, centre;
  double displacement;  // linear
  CosineSine turn;      // rotary
};

Line line_of(const FrozenAxis& axis, double position, const CosineSine& turn, double enable) {
  Line line{axis.actual_direction, axis.actual_centre, axis.sense * (position + enable * axis.zero_position), {}};
  CosineSine zero = axis.zero_turn;
  if (enable != 1) {
    const Triple between = axis.direction + enable * (axis.actual_direction - axis.direction);
    line.direction = (1 / std::sqrt(dot(between, between))) * between;
    line.centre = axis.point + enable * (axis.actual_centre - axis.point);
    if (axis.rotary) zero = turn_of(enable * axis.zero_position);
  }
  if (axis.rotary) {
    line.turn = turned_on(turn, zero);
    line.turn.s *= axis.sense;
  }
  return line;
}

/// Where functions are taken: within one period of those that repeat, at an end beyond the range of others.
double place_in(const FrozenGroup& group, const FrozenCommands& commands, std::size_t i) {
  if (!group.everywhere) return std::clamp(commands.at(i), group.lowest, group.highest);
  // The remainder is exact, so that nothing is lost after many periods.
  const double in_period = group.whole_turns ? commands.in_turn[i] : std::remainder(commands.q[i], group.period);
  return in_period + commands.by[i];
}

/// Sum of some groups of error motions of one axis.
SixErrors group_errors(const FrozenGroup* groups, std::size_t first, std::size_t count, std::size_t i,
                       const FrozenCommands& commands) {
  SixErrors errors;
  for (std::size_t g = first; g < first + count; ++g) {
    const FrozenGroup& group = groups[g];
    const double q = place_in(group, commands, i);
    switch (group.kind) {
      case FrozenGroup::Kind::chebyshev:
        add_chebyshev(group, q, errors);
        break;
      case FrozenGroup::Kind::fourier:
        add_fourier(group, group.same_turn ? commands.turn[i] : turn_of(group.scale * q), errors);
        break;
      case FrozenGroup::Kind::piecewise_cubic:
        add_piecewise(group, q, errors);
        break;
    }
  }
  return errors;
}

/// Error motions with a factor of the pose.
void add_posed_errors(const FrozenPosed& posed, const double* factors, std::size_t i, const FrozenCommands& commands,
                      SixErrors& sum) {
  const FrozenStates& states = *posed.states;
  const std::size_t first = states.first_group[i];
  for (std::size_t g = first; g < first + states.of_axis[i]; ++g) {
    const SixErrors one = group_errors(posed.group, g, 1, i, commands);
    const double factor = factors[states.pose_of[g]];
    sum.xy += factor * one.xy;
    sum.za += factor * one.za;
    sum.bc += factor * one.bc;
  }
}

/// An axis whose line moves with the pose.
void place_line(const FrozenPosed& posed, const double* factors, std::size_t i, FrozenAxis& axis) {
  const FrozenStates& states = *posed.states;
  LineErrors line = posed.line[i];
  for (std::size_t k = 0; k < states.locations; ++k) {
    const FrozenLocation& location = states.location[k];
    if (location.axis == i && location.pose != kNoFactor) line.add(factors[location.pose], posed.location[k]);
  }
  displace(line, axis);
}

/// Point and direction carried by one axis: those of the tool side towards the bed, then away from it on the
/// workpiece side.
/// @param axis  of the machine, its line where it is
/// @param e     its error motions
PointAndDirection carried(const FrozenAxis& axis, const SixErrors& e, std::size_t i, const FrozenCommands& commands,
                          double enable, PointAndDirection v) {
  const SmallRotation error{turn_of(enable * e.za[1]), turn_of(enable * e.bc[0]), turn_of(enable * e.bc[1])};
  const Triple shifted = axis.point + enable * Triple{e.xy[0], e.xy[1], e.za[0]};
  const Line line = line_of(axis, commands.at(i), commands.turn[i], enable);
  const auto by_error = [&](const PointAndDirection& at) {
    return moved(error.of(moved(at, -1 * axis.point)), shifted);
  };
  const auto back_by_error = [&](const PointAndDirection& at) {
    return moved(error.back(moved(at, -1 * shifted)), axis.point);
  };
  const auto by_motion = [&](double sign, const PointAndDirection& at) {
    if (!axis.rotary) return moved(at, sign * line.displacement * line.direction);
    const CosineSine by{line.turn.c, sign * line.turn.s};
    return moved(about(line.direction, by, moved(at, -1 * line.centre)), line.centre);
  };
  if (axis.tool_side) return axis.error_first ? by_error(by_motion(1, v)) : by_motion(1, by_error(v));
  return axis.error_first ? by_motion(-1, back_by_error(v)) : back_by_error(by_motion(-1, v));
}

/// The whole chain of a machine with errors whose factors are computed at the pose.
PointAndDirection carried_at_pose(const abbe_runtime& machine, const FrozenCommands& commands, double enable,
                                  PointAndDirection at) {
  const FrozenPosed& posed = *machine.posed;
  double factors[kFrozenStates];
  pose_factors(machine, *posed.states, commands, factors);
  for (std::size_t i = machine.axes; i-- > 0;) {
    const FrozenAxis& axis = machine.axis[i];
    SixErrors errors = group_errors(machine.group, axis.first_group, axis.groups, i, commands);
    add_posed_errors(posed, factors, i, commands, errors);
    if (posed.states->located[i]) {
      FrozenAxis placed = axis;
      place_line(posed, factors, i, placed);
      at = carried(placed, errors, i, commands, enable, at);
    } else {
      at = carried(axis, errors, i, commands, enable, at);
    }
  }
  return at;
}

}  // namespace

CosineSine turn_of(double angle) {
  const double a = angle * angle;
  if (a < kSmallerSquare) return {1 - a * (1.0 / 2 - a * (1.0 / 24)), angle * (1 - a * (1.0 / 6))};
  if (!(a < kSmallSquare)) return {std::cos(angle), std::sin(angle)};
  return {1 - a * (1.0 / 2 - a * (1.0 / 24 - a * (1.0 / 720))),
          angle * (1 - a * (1.0 / 6 - a * (1.0 / 120 - a * (1.0 / 5040))))};
}

double less_whole_turns(double angle) {
  // 2 pi in two parts (Cody and Waite, Software Manual for the Elementary Functions, 1980): the first has 33 bits, so
  // that up to 2^20 of it are exact, and so is what they leave of the angle.
  constexpr double kFirst = 0x1.921fb544p+2;
  constexpr double kSecond = 0x1.0b4611a626331p-32;
  if (std::abs(angle) <= kWholeTurn / 2) return angle;
  const double turns = std::nearbyint(angle / kWholeTurn);
  return (angle - turns * kFirst) - turns * kSecond;
}

void set_axis(const FrozenAxis& axis, std::size_t i, double to, FrozenCommands& commands) {
  commands.q[i] = commands.in_turn[i] = to;
  commands.by[i] = 0;
  if (!axis.rotary) return;
  commands.in_turn[i] = less_whole_turns(to);
  commands.turn[i] = {std::cos(commands.in_turn[i]), std::sin(commands.in_turn[i])};
}

void move_axis(const FrozenAxis& axis, std::size_t i, const FrozenCommands& from, double by, FrozenCommands& commands) {
  commands.by[i] = by;
  if (axis.rotary) commands.turn[i] = turned_on(from.turn[i], turn_of(by));
}

NominalView nominal_view(const abbe_runtime& machine, const FrozenCommands& commands, const Triple& tool,
                         bool solve_later) {
  NominalView view;
  Turned w = machine.workpiece_from_bed;
  Triple t = machine.workpiece_from_bed_shift;
  for (std::size_t i = 0; i < machine.axes; ++i) {
    const FrozenAxis& axis = machine.axis[i];
    const Triple& u = axis.direction;
    const Triple along = w * u;
    view.column[i] = axis.chain_sign * along;
    if (!axis.rotary) {
      if (!solve_later || axis.solved == FrozenAxis::kNotSolved) t = t + commands.at(i) * view.column[i];
      continue;
    }
    const Triple origin = t + w * axis.point;
    view.origin[i] = origin;
    const double c = commands.turn[i].c, s = axis.chain_sign * commands.turn[i].s;
    const Triple rest = (1 - c) * along;
    w = {c * w.x + s * (u.z * w.y - u.y * w.z) + u.x * rest, c * w.y + s * (u.x * w.z - u.z * w.x) + u.y * rest,
         c * w.z + s * (u.y * w.x - u.x * w.y) + u.z * rest};
    t = origin - w * axis.point;
  }
  view.point = t + w * (machine.tool_reference + tool);
  view.direction = w * machine.tool_direction;
  return view;
}

ActualTool actual_tool(const abbe_runtime& machine, const FrozenCommands& commands, const Triple& tool, double enable) {
  const Triple start = machine.tool_reference + tool + enable * machine.tool_error;
  const Triple& direction = machine.tool_direction;
  PointAndDirection at{{start.x, direction.x}, {start.y, direction.y}, {start.z, direction.z}};
  // The chain from the tool on: tool-side axes carry towards the bed, workpiece-side axes are left behind.
  if (machine.posed == nullptr) {
    for (std::size_t i = machine.axes; i-- > 0;) {
      const FrozenAxis& axis = machine.axis[i];
      at = carried(axis, group_errors(machine.group, axis.first_group, axis.groups, i, commands), i, commands, enable,
                   at);
    }
  } else {
    at = carried_at_pose(machine, commands, enable, at);
  }
  return {machine.workpiece_from_bed * Triple{at.x[0], at.y[0], at.z[0]} + machine.workpiece_from_bed_shift,
          machine.workpiece_from_bed * Triple{at.x[1], at.y[1], at.z[1]}};
}

}  // namespace abbe
