// Factors of states over a block of poses, and axis lines that move with them; compiled once per processor generation,
// after chain_kernel_inline.h.

#if defined(ABBE_ERRORS_CHAIN_KERNEL_STATES_INLINE_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ERRORS_CHAIN_KERNEL_STATES_INLINE_H_
#undef ABBE_ERRORS_CHAIN_KERNEL_STATES_INLINE_H_
#else
#define ABBE_ERRORS_CHAIN_KERNEL_STATES_INLINE_H_
#endif

#include <algorithm>
#include <limits>

#include "abbe/errors/chain_kernel_inline.h"

HWY_BEFORE_NAMESPACE();
namespace abbe::chain {
namespace HWY_NAMESPACE {

HWY_INLINE Vector3 scaled(const Vector3& a, Vector factor) {
  return {hn::Mul(a.x, factor), hn::Mul(a.y, factor), hn::Mul(a.z, factor)};
}
HWY_INLINE Vector3 plus_scaled(const Vector3& sum, const Vector3& a, Vector factor) {
  return {hn::MulAdd(a.x, factor, sum.x), hn::MulAdd(a.y, factor, sum.y), hn::MulAdd(a.z, factor, sum.z)};
}

/// Factors of the states of a chain over the block, and the commands of all axes.
struct StateLanes {
  Lane factor[kMaxStates];
  Lane position[kMaxAxes];
};

/// Nominal place of a carried body in the machine frame.
struct CarriedFrame {
  Vector3 column[3];
  Vector3 origin;

  HWY_INLINE Vector3 turned(const double* v) const {
    return plus_scaled(plus_scaled(scaled(column[0], set(v[0])), column[1], set(v[1])), column[2], set(v[2]));
  }
};

/// Axis lines of one side at one vector of poses, and the frames behind them.
struct SideAtPose {
  Vector3 direction[kMaxAxes], point[kMaxAxes];
};

/// Walks from the bed outwards: visit(axis of the side, frame of what it carries).
template <class Visit>
HWY_INLINE void walk_side(const WeighedSide& side, const Lane* position, std::size_t k, SideAtPose& lines,
                          const Visit& visit) {
  const Vector zero = set(0.0), one = set(1.0);
  CarriedFrame frame{{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}}, zero3()};
  for (std::size_t i = 0; i < side.axes.size(); ++i) {
    const WeighedSide::Line& line = side.axes[i];
    const bool at_bed = i == 0;  // where the frame is that of the machine
    const Vector3 direction = at_bed ? set3(line.direction) : frame.turned(line.direction);
    const Vector3 point = at_bed ? set3(line.point) : frame.turned(line.point) + frame.origin;
    lines.direction[i] = direction;
    lines.point[i] = point;
    const Vector way = hn::Mul(set(line.sense), load(position[line.axis].v + k));
    if (!line.rotary) {
      frame.origin = plus_scaled(frame.origin, direction, way);
    } else {
      const SineCosine a = sine_cosine(way);
      const Vector rest = hn::Sub(one, a.cosine);
      if (at_bed) {
        const Vector3 s = scaled(direction, a.sine), r = scaled(direction, rest);
        frame.column[0] = {hn::MulAdd(r.x, direction.x, a.cosine), hn::MulAdd(r.x, direction.y, s.z),
                           hn::MulSub(r.x, direction.z, s.y)};
        frame.column[1] = {hn::MulSub(r.x, direction.y, s.z), hn::MulAdd(r.y, direction.y, a.cosine),
                           hn::MulAdd(r.y, direction.z, s.x)};
        frame.column[2] = {hn::MulAdd(r.x, direction.z, s.y), hn::MulSub(r.y, direction.z, s.x),
                           hn::MulAdd(r.z, direction.z, a.cosine)};
        frame.origin = point - frame.turned(line.point);
        visit(i, frame);
        continue;
      }
      for (Vector3& column : frame.column) {
        const Vector along = hn::Mul(rest, dot(direction, column));
        column = plus_scaled(plus_scaled(scaled(column, a.cosine), cross(direction, column), a.sine), direction, along);
      }
      frame.origin = point - frame.turned(line.point);
    }
    visit(i, frame);
  }
}

/// Rotation about the nominal line's direction of a side.
HWY_INLINE Vector3 turned_about(const WeighedSide::Line& line, const SineCosine& angle, const Vector3& v) {
  const Vector3 u = set3(line.direction);
  const Vector along = hn::Mul(hn::Sub(set(1.0), angle.cosine), dot(u, v));
  return plus_scaled(plus_scaled(scaled(v, angle.cosine), cross(u, v), angle.sine), u, along);
}

/// What an axis carries: mass times place, kg mm, where the axes within it are at zero; and the mass, kg.
struct CarriedMoment {
  Vector3 moment;
  double mass;
};

HWY_INLINE void add_loads(const StateSource& state, std::size_t axis, CarriedMoment& carried) {
  for (const CarriedLoads& loads : state.loads) {
    if (loads.at != axis) continue;
    carried.moment = carried.moment + set3(loads.moment);
    carried.mass += loads.mass;
  }
}

/// Torque about the line of a gravity state. The loads are carried inwards, from the outermost axis to the line, and
/// meet the weight there: one vector is turned per axis, instead of a frame.
HWY_INLINE Vector torque_about(const WeighedSide& side, const StateSource& state, const Lane* position, std::size_t k,
                               const SineCosine* angle, const Vector3& weight) {
  CarriedMoment carried{zero3(), 0};
  for (std::size_t i = side.axes.size(); i-- > state.about + 1;) {
    add_loads(state, i, carried);
    const WeighedSide::Line& line = side.axes[i];
    if (line.rotary) {
      const Vector3 fixed = scaled(set3(line.point), set(carried.mass));
      carried.moment = fixed + turned_about(line, angle[i], carried.moment - fixed);
    } else {
      const Vector way = hn::Mul(set(carried.mass * line.sense), load(position[line.axis].v + k));
      carried.moment = plus_scaled(carried.moment, set3(line.direction), way);
    }
  }
  add_loads(state, state.about, carried);
  const WeighedSide::Line& line = side.axes[state.about];
  const Vector3 u = set3(line.direction), across = cross(weight, u);
  const Vector3 arm = plus_scaled(carried.moment, set3(line.point), set(-carried.mass));
  if (!line.rotary) return dot(across, arm);
  return hn::MulAdd(angle[state.about].sine, dot(across, cross(u, arm)),
                    hn::Mul(angle[state.about].cosine, dot(across, arm)));
}

/// Torques of all gravity states of one side.
inline HWY_NOINLINE void evaluate_torques(const CompiledChain& chain, std::size_t side_index, std::size_t end,
                                          StateLanes& lanes) {
  const WeighedSide& side = chain.sides[side_index];
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    SineCosine angle[kMaxAxes];
    Vector3 weight[kMaxAxes];  // as what the axes within turn sees it
    Vector3 seen = set3(chain.weight);
    for (std::size_t i = 0; i < side.axes.size(); ++i) {
      const WeighedSide::Line& line = side.axes[i];
      weight[i] = seen;
      if (!line.rotary) continue;
      angle[i] = sine_cosine(hn::Mul(set(line.sense), load(lanes.position[line.axis].v + k)));
      if (i + 1 < side.axes.size()) seen = turned_about(line, {hn::Neg(angle[i].sine), angle[i].cosine}, seen);
    }
    for (std::size_t s = 0; s < chain.states.size(); ++s) {
      const StateSource& state = chain.states[s];
      if (state.kind != StateKind::gravity || state.side != side_index) continue;
      store(torque_about(side, state, lanes.position, k, angle, weight[state.about]), lanes.factor[s].v + k);
    }
  }
}

/// d(torque)/d(command) of the axes of a gravity state's side, N m per mm or rad.
inline HWY_NOINLINE void evaluate_torque_slopes(const CompiledChain& chain, const StateSource& state, std::size_t end,
                                                const Lane* position, Lane* slope) {
  const WeighedSide& side = chain.sides[state.side];
  const Vector3 weight = set3(chain.weight);
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    SideAtPose lines;
    Vector3 moment[kMaxAxes];  // mass times place, of the loads of each axis
    double mass[kMaxAxes];
    walk_side(side, position, k, lines, [&](std::size_t i, const CarriedFrame& frame) HWY_ATTR {
      moment[i] = zero3();
      mass[i] = 0;
      for (const CarriedLoads& loads : state.loads) {
        if (loads.at != i) continue;
        moment[i] = plus_scaled(frame.turned(loads.moment), frame.origin, set(loads.mass));
        mass[i] = loads.mass;
      }
    });
    // From the last axis inwards: all that an axis carries.
    Vector3 carried = zero3();
    double carried_mass = 0;
    const Vector3 about = lines.direction[state.about];
    for (std::size_t i = side.axes.size(); i-- > 0;) {
      carried = carried + moment[i];
      carried_mass += mass[i];
      const Vector3 moves = scaled(lines.direction[i], set(side.axes[i].sense));
      Vector value = hn::Zero(Tag());
      if (i < state.about) {
        // The line turns with its loads: as if gravity turned back.
        if (side.axes[i].rotary) {
          const Vector3 arm = plus_scaled(carried, lines.point[state.about], set(-carried_mass));
          value = hn::Neg(dot(about, cross(arm, cross(moves, weight))));
        }
      } else if (side.axes[i].rotary) {
        const Vector3 arm = plus_scaled(carried, lines.point[i], set(-carried_mass));
        value = dot(about, cross(cross(moves, arm), weight));
      } else {
        value = dot(about, cross(scaled(moves, set(carried_mass)), weight));
      }
      store(value, slope[i].v + k);
    }
  }
}

/// Factors of all states; NaN where an input state is not given.
inline HWY_NOINLINE void evaluate_states(const CompiledChain& chain, const PositionArrays& positions, std::size_t first,
                                         std::size_t count, StateLanes& lanes) {
  const std::size_t end = whole_vectors(count), width = hn::Lanes(Tag());
  for (std::size_t i = 0; i < positions.axis.size(); ++i) {
    read_lane(positions.axis[i] + first, count, lanes.position[i]);
  }
  for (std::size_t side = 0; side < chain.sides.size(); ++side) evaluate_torques(chain, side, end, lanes);
  for (std::size_t s = 0; s < chain.states.size(); ++s) {
    const StateSource& state = chain.states[s];
    double* out = lanes.factor[s].v;
    const double* given = state.given < positions.state.size() ? positions.state[state.given] : nullptr;
    switch (state.kind) {
      case StateKind::measured:
      case StateKind::lag:
        if (given == nullptr) {
          std::fill_n(out, end, std::numeric_limits<double>::quiet_NaN());
          break;
        }
        read_lane(given + first, count, lanes.factor[s]);
        for (std::size_t k = 0; k < end; k += width) store(hn::Sub(load(out + k), set(state.reference)), out + k);
        break;
      case StateKind::approach:
        std::memset(out, 0, end * sizeof(double));
        if (given == nullptr) break;
        read_lane(given + first, count, lanes.factor[s]);
        for (std::size_t k = 0; k < end; k += width) {
          const Vector value = load(out + k);
          store(hn::IfThenElseZero(hn::Eq(value, value), value), out + k);
        }
        break;
      case StateKind::axis:
        for (std::size_t k = 0; k < end; k += width) {
          store(hn::Sub(load(lanes.position[state.axis].v + k), set(state.reference)), out + k);
        }
        break;
      case StateKind::gravity:
        break;
      case StateKind::product:
        for (std::size_t k = 0; k < end; k += width) {
          store(hn::Mul(load(lanes.factor[state.first].v + k), load(lanes.factor[state.second].v + k)), out + k);
        }
        break;
    }
  }
}

/// An axis line displaced by location errors with states, at every pose.
struct LineLanes {
  Lane direction[3], centre[3];
  Lane zero_position;
  Lane tilt_axes[3][3];  ///< [EA0, EB0, EC0]: axis about which it turns the line
};

inline HWY_NOINLINE void displace_lines(const AxisStep& step, const Lane* factor, std::size_t end, LineLanes& line) {
  const Vector one = set(1.0), zero = set(0.0);
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    Vector effect[7];
    for (int i = 0; i < 7; ++i) effect[i] = set(step.fixed_effect[i]);
    for (const AxisStep::Location& location : step.locations) {
      if (location.state == kNoState) continue;
      const Vector value = hn::Mul(set(location.value), load(factor[location.state].v + k));
      for (int i = 0; i < 7; ++i) effect[i] = hn::MulAdd(value, set(location.effect[i]), effect[i]);
    }
    const Vector3 centre = set3(step.reference) + Vector3{effect[0], effect[1], effect[2]};
    const ErrorRotation e = error_rotation({effect[3], effect[4], effect[5]});
    Vector3 direction = set3(step.nominal_direction);
    turn(e.a, direction.y, direction.z);
    turn(e.b, direction.z, direction.x);
    turn(e.c, direction.x, direction.y);
    Vector3 about_a{one, zero, zero}, about_b{zero, one, zero};
    turn(e.b, about_a.z, about_a.x);
    turn(e.c, about_a.x, about_a.y);
    turn(e.c, about_b.x, about_b.y);
    store(direction, line.direction, k);
    store(centre, line.centre, k);
    store(effect[6], line.zero_position.v + k);
    store(about_a, line.tilt_axes[0], k);
    store(about_b, line.tilt_axes[1], k);
    store({zero, zero, one}, line.tilt_axes[2], k);
  }
}

/// Rotation about the line of one vector of poses, by sign * (q + zero position).
HWY_INLINE Matrix3 moving_rotation(const AxisStep& step, const Vector3& u, Vector position, Vector zero_position) {
  const SineCosine a = sine_cosine(hn::Mul(set(step.sign), hn::Add(position, zero_position)));
  const Vector rest = hn::Sub(set(1.0), a.cosine);
  const Vector3 s = scaled(u, a.sine), r = scaled(u, rest);
  return {{hn::MulAdd(r.x, u.x, a.cosine), hn::MulSub(r.x, u.y, s.z), hn::MulAdd(r.x, u.z, s.y)},
          {hn::MulAdd(r.x, u.y, s.z), hn::MulAdd(r.y, u.y, a.cosine), hn::MulSub(r.y, u.z, s.x)},
          {hn::MulSub(r.x, u.z, s.y), hn::MulAdd(r.y, u.z, s.x), hn::MulAdd(r.z, u.z, a.cosine)}};
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe::chain
HWY_AFTER_NAMESPACE();

#endif  // per target
