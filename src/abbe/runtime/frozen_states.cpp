#include "abbe/runtime/frozen_states.h"

#include <algorithm>
#include <cmath>

#include "abbe/runtime/frozen_values.h"

namespace abbe {
namespace {

/// Torque about the line of an axis: the sum of u . ((p - c) x weight), as state.cpp.
double torque(const abbe_runtime& machine, const FrozenStates& states, const FrozenState& state,
              const FrozenCommands& commands) {
  const bool tool_side = machine.axis[state.of].tool_side;
  Turned r{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Triple t{0, 0, 0}, about{0, 0, 0}, centre{0, 0, 0};
  double sum = 0;
  // From the bed outwards; axes of the workpiece side stand before those of the tool side, outermost first. What an
  // axis carries comes after it, so its line is known when the loads are met.
  for (std::size_t n = 0; n < machine.axes; ++n) {
    const std::size_t i = tool_side ? n : machine.axes - 1 - n;
    const FrozenAxis& axis = machine.axis[i];
    if (axis.tool_side != tool_side) continue;
    const Triple u = r * axis.direction, c = t + r * axis.point;
    if (i == state.of) {
      about = u;
      centre = c;
    }
    if (axis.rotary) {
      const double cosine = commands.turn[i].c, sine = axis.sense * commands.turn[i].s;
      const Triple d = axis.direction;
      const Triple rest = (1 - cosine) * u;
      r = {cosine * r.x + sine * (d.z * r.y - d.y * r.z) + d.x * rest,
           cosine * r.y + sine * (d.x * r.z - d.z * r.x) + d.y * rest,
           cosine * r.z + sine * (d.y * r.x - d.x * r.y) + d.z * rest};
      t = c - r * axis.point;
    } else {
      t = t + (axis.sense * commands.at(i)) * u;
    }
    for (std::size_t k = state.first_load; k < state.first_load + state.loads; ++k) {
      const FrozenLoad& load = states.load[k];
      if (load.axis == i) sum += dot(about, cross(t + r * load.point - centre, load.weight));
    }
  }
  return sum;
}

double factor_at(const abbe_runtime& machine, const FrozenStates& states, std::size_t place,
                 const FrozenCommands& commands) {
  const FrozenState& state = states.state[place];
  if (state.kind == FrozenState::Kind::gravity) return torque(machine, states, state, commands);
  return std::clamp(commands.at(state.of), state.from, state.to) - state.reference;
}

}  // namespace

void displace(const LineErrors& line, FrozenAxis& axis) {
  const double ca = std::cos(line.tilt.x), sa = std::sin(line.tilt.x);
  const double cb = std::cos(line.tilt.y), sb = std::sin(line.tilt.y);
  const double cc = std::cos(line.tilt.z), sc = std::sin(line.tilt.z);
  const Triple& d = axis.direction;
  const double y = ca * d.y - sa * d.z, z1 = sa * d.y + ca * d.z;
  const double x = cb * d.x + sb * z1, z = cb * z1 - sb * d.x;
  const Triple turned{cc * x - sc * y, sc * x + cc * y, z};
  axis.actual_direction = (1 / length(turned)) * turned;
  axis.actual_centre = axis.point + line.shift;
  axis.zero_position = line.zero;
  axis.zero_turn = turn_of(line.zero);
}

void pose_factors(const abbe_runtime& machine, const FrozenStates& states, const FrozenCommands& commands,
                  double* factors) {
  for (std::size_t k = 0; k < states.poses; ++k) {
    const FrozenFactor& factor = states.pose[k];
    factors[k] = factor_at(machine, states, factor.first, commands);
    if (factor.second != kNoFactor) factors[k] *= factor_at(machine, states, factor.second, commands);
  }
}

void put_in(const abbe_runtime& read, const FrozenStates& states, const double* factors, FrozenGroup* group,
            FrozenPosed& posed, abbe_runtime& live) {
  const auto coefficients = [&](std::size_t g) { return const_cast<double*>(group[g].coefficients); };
  for (std::size_t b = 0; b < states.blocks; ++b) {
    const FrozenBlock& block = states.block[b];
    const std::size_t count = 6 * group_rows(group[block.group]);
    double* const to = coefficients(block.group);
    // Blocks stand in the order of their groups.
    if (b == 0 || states.block[b - 1].group != block.group)
      std::copy_n(read.group[block.group].coefficients, count, to);
    for (std::size_t k = 0; k < count; ++k) to[k] += factors[block.factor] * block.coefficients[k];
  }
  posed.line.fill({});
  for (std::size_t k = 0; k < states.locations; ++k) {
    const FrozenLocation& location = states.location[k];
    const double factor = location.factor == kNoFactor ? 1 : factors[location.factor];
    posed.location[k] = {};
    posed.location[k].add(factor, location.line);
    if (location.pose == kNoFactor) posed.line[location.axis].add(factor, location.line);
  }
  for (std::size_t i = 0; i < read.axes; ++i) {
    if (states.placed[i]) displace(posed.line[i], live.axis[i]);
  }
}

}  // namespace abbe
