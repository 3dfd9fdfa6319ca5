#include "abbe/runtime/frozen_pose.h"

#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

/// Below, the series end with terms of 1e-19 of the result.
constexpr double kSmallAngle = 0.02;

void add(double factor, const double* coefficients, double* sum) {
  for (int k = 0; k < 8; ++k) sum[k] += factor * coefficients[k];
}

void add_chebyshev(const FrozenGroup& group, double position, double* sum) {
  const double s = group.scale * position + group.shift;
  const double* row = group.coefficients;
  double t = 1, before = s;  // T_0 and T_-1 = T_1
  for (std::size_t k = 0; k < group.functions; ++k, row += 8) {
    add(t, row, sum);
    const double next = 2 * s * t - before;
    before = t;
    t = next;
  }
}

void add_fourier(const FrozenGroup& group, const CosineSine& first, double* sum) {
  const double* row = group.coefficients;
  add(1, row, sum);
  CosineSine turn = first;
  for (std::size_t k = 1; k + 1 < group.functions; k += 2) {
    row += 8;
    add(turn.c, row, sum);
    row += 8;
    add(turn.s, row, sum);
    turn = turned_on(turn, first);
  }
}

void add_piecewise(const FrozenGroup& group, double position, double* sum) {
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
  const double* row = group.coefficients + 32 * i;
  add(1, row, sum);
  add(u, row + 8, sum);
  add(u * u, row + 16, sum);
  add(u * u * u, row + 24, sum);
}

/// Rz(EC) Ry(EB) Rx(EA) of a vector.
struct SmallRotation {
  CosineSine a, b, c;
};
Triple operator*(const SmallRotation& r, const Triple& v) {
  const double y = r.a.c * v.y - r.a.s * v.z, z = r.a.s * v.y + r.a.c * v.z;
  const double x = r.b.c * v.x + r.b.s * z, z2 = r.b.c * z - r.b.s * v.x;
  return {r.c.c * x - r.c.s * y, r.c.s * x + r.c.c * y, z2};
}
Triple times_inverse(const SmallRotation& r, const Triple& v) {
  const double x = r.c.c * v.x + r.c.s * v.y, y = r.c.c * v.y - r.c.s * v.x;
  const double x2 = r.b.c * x - r.b.s * v.z, z = r.b.s * x + r.b.c * v.z;
  return {x2, r.a.c * y + r.a.s * z, r.a.c * z - r.a.s * y};
}

/// Rotation about a unit direction, of vectors.
Triple about(const Triple& u, const CosineSine& turn, const Triple& v) {
  const double along = (1 - turn.c) * dot(u, v);
  return turn.c * v + turn.s * cross(u, v) + along * u;
}

/// The line of an axis with so much of its location errors.
struct Line {
  Triple direction, centre;
  double displacement = 0;  // linear
  CosineSine turn;          // rotary
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

/// A body's point and direction carried by one axis, towards the bed (`away` false) or from it.
void carry(const abbe_runtime& machine, const FrozenAxis& axis, double position, const CosineSine& turn, double enable,
           ActualTool& tool) {
  alignas(64) double e[8];
  axis_errors(machine, axis, position, turn, e);
  const SmallRotation error{turn_of(enable * e[3]), turn_of(enable * e[4]), turn_of(enable * e[5])};
  const Triple shift = enable * Triple{e[0], e[1], e[2]};
  const Line line = line_of(axis, position, turn, enable);
  Triple& p = tool.point;
  Triple& d = tool.direction;
  const auto by_error = [&] {
    p = error * (p - axis.point) + axis.point + shift;
    d = error * d;
  };
  const auto back_by_error = [&] {
    p = times_inverse(error, p - axis.point - shift) + axis.point;
    d = times_inverse(error, d);
  };
  const auto by_motion = [&](double sign) {
    if (!axis.rotary) {
      p = p + sign * line.displacement * line.direction;
      return;
    }
    const CosineSine by{line.turn.c, sign * line.turn.s};
    p = about(line.direction, by, p - line.centre) + line.centre;
    d = about(line.direction, by, d);
  };
  if (axis.tool_side) {
    if (axis.error_first) {
      by_motion(1);
      by_error();
    } else {
      by_error();
      by_motion(1);
    }
  } else if (axis.error_first) {
    back_by_error();
    by_motion(-1);
  } else {
    by_motion(-1);
    back_by_error();
  }
}

}  // namespace

CosineSine turn_of(double angle) {
  if (std::abs(angle) > kSmallAngle) return {std::cos(angle), std::sin(angle)};
  const double a = angle * angle;
  return {1 - a * (1.0 / 2 - a * (1.0 / 24 - a * (1.0 / 720))),
          angle * (1 - a * (1.0 / 6 - a * (1.0 / 120 - a * (1.0 / 5040))))};
}

void move_axis(const FrozenAxis& axis, std::size_t i, double to, FrozenCommands& commands) {
  if (axis.rotary) commands.turn[i] = turned_on(commands.turn[i], turn_of(to - commands.q[i]));
  commands.q[i] = to;
}

void axis_errors(const abbe_runtime& machine, const FrozenAxis& axis, double position, const CosineSine& turn,
                 double errors[8]) {
  for (int k = 0; k < 8; ++k) errors[k] = 0;
  for (std::size_t g = axis.first_group; g < axis.first_group + axis.groups; ++g) {
    const FrozenGroup& group = machine.group[g];
    const double q = group.everywhere ? position : std::clamp(position, group.lowest, group.highest);
    switch (group.kind) {
      case FrozenGroup::Kind::chebyshev:
        add_chebyshev(group, q, errors);
        break;
      case FrozenGroup::Kind::fourier:
        add_fourier(group, group.same_turn ? turn : turn_of(group.scale * q), errors);
        break;
      case FrozenGroup::Kind::piecewise_cubic:
        add_piecewise(group, q, errors);
        break;
    }
  }
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
      if (!solve_later || axis.solved == FrozenAxis::kNotSolved) t = t + commands.q[i] * view.column[i];
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

ActualTool actual_tool(const abbe_runtime& machine, const FrozenCommands& commands, const Triple& tool,
                       double enable) {
  ActualTool at{machine.tool_reference + tool + enable * machine.tool_error, machine.tool_direction};
  // The chain from the tool on: tool-side axes carry towards the bed, workpiece-side axes are left behind.
  for (std::size_t i = machine.axes; i-- > 0;) {
    carry(machine, machine.axis[i], commands.q[i], commands.turn[i], enable, at);
  }
  at.point = machine.workpiece_from_bed * at.point + machine.workpiece_from_bed_shift;
  at.direction = machine.workpiece_from_bed * at.direction;
  return at;
}

}  // namespace abbe
