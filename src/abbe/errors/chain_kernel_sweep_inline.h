// The sweep of a differentiation, and what states add to it; compiled once per processor generation, after
// chain_kernel_states_inline.h.

#if defined(ABBE_ERRORS_CHAIN_KERNEL_SWEEP_INLINE_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ERRORS_CHAIN_KERNEL_SWEEP_INLINE_H_
#undef ABBE_ERRORS_CHAIN_KERNEL_SWEEP_INLINE_H_
#else
#define ABBE_ERRORS_CHAIN_KERNEL_SWEEP_INLINE_H_
#endif

#include "abbe/errors/chain_kernel_states_inline.h"

HWY_BEFORE_NAMESPACE();
namespace abbe::chain {
namespace HWY_NAMESPACE {

/// Swept from the seen point backwards: the point between two steps and, per row, what a displacement of it does.
struct Sweep {
  Lane point[3];
  Lane force[kRowsAtOnce][3];
  Lane moment[kRowsAtOnce][3];
  Lane channel[kRowsAtOnce][8];  ///< derivative by what moves the present step; the last by several of them together
  Lane by_command[kRowsAtOnce];
  AxisLanes lanes;
  Lane slope[6];  ///< derivative of the error motions by the command
};

/// What a chain with states needs besides.
struct StateSweep {
  StateLanes states;
  Lane by_factor[kRowsAtOnce][kMaxStates];  ///< derivative by the factors
  LineLanes line;                           ///< of the present step
  Lane product;
  Lane slope[kMaxAxes];
};

/// Takes the motion of a step back, as take_back_motion() does, where location errors with states move its line.
inline HWY_NOINLINE void take_back_moving_motion(const AxisStep& step, std::size_t rows, std::size_t end,
                                                 const LineLanes& line, Sweep& s) {
  const Vector sign = set(step.sign);
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    const Vector3 out = load(s.point, k), direction = load(line.direction, k), centre = load(line.centre, k);
    const Vector3 tilt[3] = {load(line.tilt_axes[0], k), load(line.tilt_axes[1], k), load(line.tilt_axes[2], k)};
    const Vector position = load(s.lanes.position.v + k), zero_position = load(line.zero_position.v + k);
    Matrix3 r{};
    Vector3 moved = zero3(), r_in = zero3();
    const Vector3 r_out = out - centre;
    if (step.rotary) {
      r = moving_rotation(step, direction, position, zero_position);
      r_in = transposed_times(r, r_out);
      store(r_in + centre, s.point, k);
    } else {
      moved = scaled(direction, hn::Mul(hn::Add(position, zero_position), sign));
      store(out - moved, s.point, k);
    }
    for (std::size_t row = 0; row < rows; ++row) {
      const Vector3 f = load(s.force[row], k);
      if (!step.rotary) {
        const Vector3 lever = cross(moved, f);
        store(zero3(), s.channel[row], k);
        store({dot(tilt[0], lever), dot(tilt[1], lever), dot(tilt[2], lever)}, s.channel[row] + 3, k);
        store(hn::Mul(sign, dot(f, direction)), s.channel[row][6].v + k);
        continue;
      }
      const Vector3 m = load(s.moment[row], k);
      const Vector3 f_in = transposed_times(r, f), m_in = transposed_times(r, m);
      const Vector3 about = cross(r_out, f) + m;
      const Vector3 change = about - (cross(r_in, f_in) + m_in);
      store(f - f_in, s.channel[row], k);
      store({dot(tilt[0], change), dot(tilt[1], change), dot(tilt[2], change)}, s.channel[row] + 3, k);
      store(hn::Mul(sign, dot(about, direction)), s.channel[row][6].v + k);
      store(f_in, s.force[row], k);
      store(m_in, s.moment[row], k);
    }
  }
}

/// Channel 7 becomes the derivative by a location error that acts through several channels.
inline HWY_NOINLINE void combine(const AxisStep::Location& location, std::size_t rows, std::size_t end, Sweep& s) {
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
      Vector sum = hn::Zero(Tag());
      for (int c = 0; c < 7; ++c) sum = hn::MulAdd(load(s.channel[row][c].v + k), set(location.effect[c]), sum);
      store(sum, s.channel[row][7].v + k);
    }
  }
}

/// Adds to the derivatives by factors what the error motions of a step do.
inline HWY_NOINLINE void add_factors_of_errors(const CompiledChain& chain, const AxisStep& step, std::size_t rows,
                                               std::size_t end, const Sweep& s, StateSweep& states) {
  Lane value[6];
  for (std::size_t g = step.plain_groups; g < step.groups.size(); ++g) {
    const FunctionGroup& group = step.groups[g];
    if (!chain.states[group.state].moves) continue;
    evaluate_group(group, chain.numbers.data(), s.lanes, end, 0, value);
    for (const Series& series : group.series) {
      for (std::size_t row = 0; row < rows; ++row) {
        double* sum = states.by_factor[row][group.state].v;
        for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
          Vector channel = load(s.channel[row][series.component].v + k);
          if (series.gives_half()) channel = hn::Add(channel, channel);
          store(hn::MulAdd(channel, load(value[series.component].v + k), load(sum + k)), sum + k);
        }
      }
    }
  }
}

/// Adds to the derivatives by factors what the location errors of a step do.
inline HWY_NOINLINE void add_factors_of_locations(const CompiledChain& chain, const AxisStep& step, std::size_t rows,
                                                  std::size_t end, Sweep& s, StateSweep& states) {
  for (const AxisStep::Location& location : step.locations) {
    if (location.state == kNoState || !chain.states[location.state].moves) continue;
    combine(location, rows, end, s);
    for (std::size_t row = 0; row < rows; ++row) {
      double* sum = states.by_factor[row][location.state].v;
      for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
        store(hn::MulAdd(load(s.channel[row][7].v + k), set(location.value), load(sum + k)), sum + k);
      }
    }
  }
}

/// Derivatives by factors become derivatives by the commands that they depend on.
inline HWY_NOINLINE void add_factors_of_commands(const CompiledChain& chain, const DifferentiateCall& call,
                                                 std::size_t first_row, std::size_t rows, std::size_t end,
                                                 StateSweep& states) {
  const std::size_t count = call.positions.count;
  const auto add = [&](std::size_t axis, std::size_t state, const Lane* slope) {
    for (std::size_t row = 0; row < rows; ++row) {
      double* out = call.by_position + (axis * call.rows.size() + first_row + row) * count;
      const double* by = states.by_factor[row][state].v;
      for (std::size_t k = 0; k < count; ++k) out[k] += slope == nullptr ? by[k] : by[k] * slope->v[k];
    }
  };
  // Products stand last, so that their factors are told before they are used.
  for (std::size_t s = chain.states.size(); s-- > 0;) {
    const StateSource& state = chain.states[s];
    if (!state.moves) continue;
    if (state.kind == StateKind::product) {
      const double* factor = states.states.factor[state.second].v;
      for (std::size_t to : {state.first, state.second}) {
        for (std::size_t row = 0; row < rows; ++row) {
          const double* by = states.by_factor[row][s].v;
          double* sum = states.by_factor[row][to].v;
          for (std::size_t k = 0; k < end; ++k) sum[k] += by[k] * factor[k];
        }
        factor = states.states.factor[state.first].v;
      }
    } else if (state.kind == StateKind::axis) {
      add(state.axis, s, nullptr);
    } else {
      evaluate_torque_slopes(chain, state, end, states.states.position, states.slope);
      const std::vector<WeighedSide::Line>& axes = chain.sides[state.side].axes;
      for (std::size_t i = 0; i < axes.size(); ++i) add(axes[i].axis, s, &states.slope[i]);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe::chain
HWY_AFTER_NAMESPACE();

#endif  // per target
