#include <cstring>
#include <type_traits>

#include "abbe/errors/chain_kernel_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "abbe/errors/chain_kernel_forward.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include "abbe/errors/chain_kernel_inline.h"
#include "abbe/errors/chain_kernel_moving_inline.h"
#include "abbe/errors/chain_kernel_states_inline.h"

HWY_BEFORE_NAMESPACE();
namespace abbe::chain {
namespace HWY_NAMESPACE {
namespace {

/// What the operations of a step are. Known to the compiler where it is the usual one, so that no vector asks.
struct StepShape {
  bool rotary, inverted, error_first, has_errors, has_angles, first_order;
  bool from_units;          ///< the first step, with columns that are ex and ey before it
  bool may_begin, may_end;  ///< false: certainly not the first, the last step
};
StepShape shape_of(const AxisStep& step, bool from_units = false) {
  return {.rotary = step.rotary,
          .inverted = step.inverted,
          .error_first = step.error_first,
          .has_errors = step.has_errors,
          .has_angles = step.has_angles,
          .first_order = step.first_order,
          .from_units = from_units,
          .may_begin = true,
          .may_end = true};
}

template <int kColumns, class Turn>
HWY_INLINE void apply_turns(const StepShape shape, const ErrorTurns<Turn>& e, const Vector3& shift,
                            Moving<kColumns>& m) {
  if (shape.inverted) {
    m.point = m.point - shift;
    turn_all_back(e, m);
  } else {
    if constexpr (kColumns == 2 && std::is_same_v<Turn, Shears>) {
      shape.from_units ? turn_units(e, m) : turn_all(e, m);
    } else {
      turn_all(e, m);
    }
    m.point = m.point + shift;
  }
}

/// The point is relative to the reference.
/// @param kLarge  angles may be beyond the short series; decided per pose, so that a result does not depend on its
///     neighbours
template <int kColumns, bool kLarge>
HWY_INLINE void apply_error(const StepShape shape, const AxisLanes& lanes, std::size_t k, Moving<kColumns>& m) {
  const Vector3 shift = load(lanes.error, k);
  if (!shape.has_angles) {
    m.point = shape.inverted ? m.point - shift : m.point + shift;
    return;
  }
  const Vector3 half_angles = load(lanes.error + 3, k), angles = half_angles + half_angles;
  if (shape.first_order) {
    if (shape.inverted) {
      m.point = first_order_inverse(angles, m.point - shift);
      for (int i = 0; i < kColumns; ++i) m.column[i] = first_order_inverse(angles, m.column[i]);
    } else {
      m.point = m.point + shift + cross(angles, m.point);
      for (int i = 0; i < kColumns; ++i) m.column[i] = m.column[i] + cross(angles, m.column[i]);
    }
    return;
  }
  if (kLarge) {
    Moving<kColumns> far = m;
    apply_turns(shape, error_rotation(angles), shift, far);
    apply_turns(shape, error_shears(half_angles), shift, m);
    choose(are_large(half_angles), far, m);
  } else {
    apply_turns(shape, error_shears(half_angles), shift, m);
  }
}

/// The point is relative to the centre of a rotary axis; `after` is added to it.
template <int kColumns>
HWY_INLINE void apply_motion(const StepShape shape, const StepVectors& step, const AxisLanes& lanes, std::size_t k,
                             const Vector3& after, Moving<kColumns>& m) {
  if (!shape.rotary) {
    const Vector way = hn::Add(load(lanes.position.v + k), step.zero_position);
    m.point = {hn::MulAdd(way, step.signed_direction.x, m.point.x), hn::MulAdd(way, step.signed_direction.y, m.point.y),
               hn::MulAdd(way, step.signed_direction.z, m.point.z)};
    return;
  }
  const SineCosine angle = motion_angle(step, {load(lanes.sine.v + k), load(lanes.cosine.v + k)});
  const Matrix3 r = rotation(step, angle);
  m.point = times_plus(r, m.point, after);
  for (int i = 0; i < kColumns; ++i) m.column[i] = times(r, m.column[i]);
}

/// One vector of poses.
template <int kColumns, bool kLarge>
HWY_INLINE void pass_vector(const StepShape shape, const StepVectors& step, const AxisLanes& lanes, std::size_t k,
                            Moving<kColumns>& m) {
  if (shape.rotary || step.has_offsets) m.point = m.point - step.before;
  if (!shape.has_errors) {
    apply_motion(shape, step, lanes, k, step.after, m);
  } else if (shape.error_first) {
    apply_error<kColumns, kLarge>(shape, lanes, k, m);
    if (shape.rotary) m.point = m.point + step.between;
    apply_motion(shape, step, lanes, k, step.after, m);
  } else {
    apply_motion(shape, step, lanes, k, step.between, m);
    apply_error<kColumns, kLarge>(shape, lanes, k, m);
    if (shape.rotary) m.point = m.point + step.after;
  }
  if (!shape.rotary && step.has_offsets) m.point = m.point + step.after;
}

template <int kColumns>
HWY_NOINLINE void pass_large_angles(const AxisStep& step, bool from_units, const AxisLanes& lanes, std::size_t k,
                                    State& state) {
  Moving<kColumns> m = moving_at<kColumns>(state, k);
  pass_vector<kColumns, true>(shape_of(step, from_units), vectors_of(step), lanes, k, m);
  keep(m, state, k);
}

template <int kColumns>
HWY_INLINE void pass_shape(const StepShape shape, const AxisStep& step, const AxisLanes& lanes, const Ends& caller_ends,
                           State& state) {
  const StepVectors vectors = vectors_of(step);
  const Ends ends = caller_ends;  // a copy, which no store in the loop can change
  const EndVectors end_vectors = vectors_of(ends);
  const bool turns = shape.has_errors && shape.has_angles && !shape.first_order;
  for (std::size_t k = 0; k < ends.count; k += hn::Lanes(Tag())) {
    if (shape.may_begin && !shape.from_units) begin_vector<kColumns>(ends, k, state);
    // Apart, so that what is rare costs the rest no registers.
    if (turns && HWY_UNLIKELY(!hn::AllFalse(Tag(), are_large(load(lanes.error + 3, k))))) {
      if (shape.from_units) begin_vector<kColumns>(ends, k, state);
      pass_large_angles<kColumns>(step, shape.from_units, lanes, k, state);
    } else {
      Moving<kColumns> m;
      if (shape.from_units) {
        m.point = first_point(ends, end_vectors, k, false);
      } else {
        m = moving_at<kColumns>(state, k);
      }
      pass_vector<kColumns, false>(shape, vectors, lanes, k, m);
      // From registers: a way through the state would cost a hundredth of the time of a pose.
      if (shape.may_end && ends.end != nullptr && k + hn::Lanes(Tag()) <= ends.count) {
        write_results<kColumns>(ends, end_vectors, k, m, WriteWhole());
        continue;
      }
      keep(m, state, k);
    }
    if (shape.may_end) finish_vector<kColumns>(ends, k, state);
  }
}
template <int kColumns>
HWY_NOINLINE void pass_any_axis(const AxisStep& step, const AxisLanes& lanes, const Ends& ends, State& state) {
  pass_shape<kColumns>(shape_of(step), step, lanes, ends, state);
}
/// Errors with angles, composed exactly in the order of ISO 230-1. Whether the step may be the first or the last one of
/// its chain is known to the compiler.
template <int kColumns, bool kRotary, bool kInverted, bool kMayBegin, bool kMayEnd, bool kFromUnits>
HWY_NOINLINE void pass_usual_axis_there(const AxisStep& step, const AxisLanes& lanes, const Ends& ends, State& state) {
  constexpr StepShape kShape{.rotary = kRotary,
                             .inverted = kInverted,
                             .error_first = kRotary == kInverted,
                             .has_errors = true,
                             .has_angles = true,
                             .first_order = false,
                             .from_units = kFromUnits,
                             .may_begin = kMayBegin,
                             .may_end = kMayEnd};
  pass_shape<kColumns>(kShape, step, lanes, ends, state);
}
template <int kColumns, bool kRotary, bool kInverted, bool kFromUnits = false>
HWY_INLINE void pass_usual_axis(const AxisStep& step, const AxisLanes& lanes, const Ends& ends, State& state) {
  if (ends.start != nullptr) {
    pass_usual_axis_there<kColumns, kRotary, kInverted, true, true, kFromUnits>(step, lanes, ends, state);
  } else if (ends.end != nullptr) {
    pass_usual_axis_there<kColumns, kRotary, kInverted, false, true, false>(step, lanes, ends, state);
  } else {
    pass_usual_axis_there<kColumns, kRotary, kInverted, false, false, false>(step, lanes, ends, state);
  }
}

template <int kColumns>
HWY_INLINE void pass_axis(const AxisStep& step, const AxisLanes& lanes, const Ends& ends, State& state) {
  const bool usual =
      step.has_errors && step.has_angles && !step.first_order && step.error_first == (step.rotary == step.inverted);
  if (!usual) {
    pass_any_axis<kColumns>(step, lanes, ends, state);
  } else if (step.rotary) {
    step.inverted ? pass_usual_axis<kColumns, true, true>(step, lanes, ends, state)
                  : pass_usual_axis<kColumns, true, false>(step, lanes, ends, state);
  } else if (step.inverted) {
    pass_usual_axis<kColumns, false, true>(step, lanes, ends, state);
  } else if (begins_with_units<kColumns>(ends)) {
    pass_usual_axis<kColumns, false, false, kColumns == 2>(step, lanes, ends, state);
  } else {
    pass_usual_axis<kColumns, false, false>(step, lanes, ends, state);
  }
}

/// The same where location errors with states move the line.
template <int kColumns>
HWY_NOINLINE void pass_moving_axis(const AxisStep& step, const AxisLanes& lanes, const Lane* factor, const Ends& ends,
                                   State& state) {
  LineLanes line;
  displace_lines(step, factor, whole_vectors(ends.count), line);
  const StepShape shape = shape_of(step);
  for (std::size_t k = 0; k < ends.count; k += hn::Lanes(Tag())) {
    begin_vector<kColumns>(ends, k, state);
    Moving<kColumns> m = moving_at<kColumns>(state, k);
    const Vector3 reference = set3(step.reference);
    const auto apply = [&]() HWY_ATTR {
      if (!shape.has_errors) return;
      m.point = m.point - reference;
      apply_error<kColumns, true>(shape, lanes, k, m);
      m.point = m.point + reference;
    };
    if (shape.error_first) apply();
    const Vector3 direction = load(line.direction, k);
    const Vector position = load(lanes.position.v + k), zero_position = load(line.zero_position.v + k);
    if (step.rotary) {
      const Matrix3 r = moving_rotation(step, direction, position, zero_position);
      const Vector3 centre = load(line.centre, k);
      m.point = times(r, m.point - centre) + centre;
      for (int i = 0; i < kColumns; ++i) m.column[i] = times(r, m.column[i]);
    } else {
      m.point = plus_scaled(m.point, direction, hn::Mul(hn::Add(position, zero_position), set(step.sign)));
    }
    if (!shape.error_first) apply();
    keep(m, state, k);
    finish_vector<kColumns>(ends, k, state);
  }
}

template <int kColumns>
HWY_NOINLINE void pass_no_axis(const Ends& ends, State& state) {
  for (std::size_t k = 0; k < ends.count; k += hn::Lanes(Tag())) {
    begin_vector<kColumns>(ends, k, state);
    finish_vector<kColumns>(ends, k, state);
  }
}

template <int kColumns>
void run(const CompiledChain& chain, const PositionArrays& positions, std::size_t first, Ends& ends,
         const Lane* factor) {
  State state;
  AxisLanes lanes;
  for (std::size_t i = 0; i < chain.steps.size(); ++i) {
    const AxisStep& step = chain.steps[i];
    ends.start = i == 0 ? &chain.start : nullptr;
    ends.end = i + 1 == chain.steps.size() ? &chain.end : nullptr;
    evaluate_axis(chain, step, positions.axis[step.axis] + first, ends.count, lanes, factor);
    if (step.moving_line) {
      pass_moving_axis<kColumns>(step, lanes, factor, ends, state);
    } else {
      pass_axis<kColumns>(step, lanes, ends, state);
    }
  }
  if (chain.steps.empty()) pass_no_axis<kColumns>(ends, state);
}

/// The column that is wanted alone; -1: none or all.
int only_column(const RotationArrays& rotation) {
  for (int i = 0; i < 3; ++i) {
    if (rotation.r[i] != nullptr && rotation.r[(i + 1) % 3] == nullptr && rotation.r[(i + 2) % 3] == nullptr) return i;
  }
  return -1;
}

/// @param factor  of the states of the chain; null if it has none
void transform_with(const CompiledChain& chain, const PositionArrays& positions, std::size_t first, std::size_t count,
                    const ConstPointArrays& start, const PointArrays& seen, const RotationArrays& rotation,
                    std::uint8_t* covered, const Lane* factor) {
  Ends ends{.count = count,
            .start = &chain.start,
            .end = &chain.end,
            .from = {start.x + first, start.y + first, start.z + first},
            .first_column = 0,
            .results = {}};
  ends.results.point[0] = seen.x + first;
  ends.results.point[1] = seen.y + first;
  ends.results.point[2] = seen.z + first;
  const int alone = only_column(rotation);
  for (int i = 0; i < 9; ++i) {
    if (rotation.r[i] != nullptr) ends.results.column[alone < 0 ? i % 3 : 0][i / 3] = rotation.r[i] + first;
  }
  if (alone >= 0) {
    ends.first_column = alone;
    run<1>(chain, positions, first, ends, factor);
  } else if (rotation.r[0] == nullptr) {
    run<0>(chain, positions, first, ends, factor);
  } else if (chain.first_order) {
    run<3>(chain, positions, first, ends, factor);
  } else {
    run<2>(chain, positions, first, ends, factor);
  }
  if (covered == nullptr) return;
  std::memset(covered + first, 1, count);
  for (const AxisStep& step : chain.steps) {
    const double* q = positions.axis[step.axis] + first;
    for (std::size_t k = 0; k < count; ++k) {
      // Not covered if the command is no number.
      covered[first + k] =
          static_cast<std::uint8_t>(covered[first + k] & (q[k] >= step.lowest && q[k] <= step.highest));
    }
  }
}

HWY_NOINLINE void transform_with_states(const CompiledChain& chain, const PositionArrays& positions, std::size_t first,
                                        std::size_t count, const ConstPointArrays& start, const PointArrays& seen,
                                        const RotationArrays& rotation, std::uint8_t* covered) {
  StateLanes lanes;
  evaluate_states(chain, positions, first, count, lanes);
  transform_with(chain, positions, first, count, start, seen, rotation, covered, lanes.factor);
  if (covered == nullptr) return;
  for (std::size_t s = 0; s < chain.states.size(); ++s) {
    for (std::size_t k = 0; k < count; ++k) {
      const double value = lanes.factor[s].v[k];
      covered[first + k] = static_cast<std::uint8_t>(covered[first + k] & (value - value == 0));  // finite
    }
  }
}

void transform_block(const CompiledChain& chain, const PositionArrays& positions, std::size_t first, std::size_t count,
                     const ConstPointArrays& start, const PointArrays& seen, const RotationArrays& rotation,
                     std::uint8_t* covered) {
  if (chain.states.empty()) {
    transform_with(chain, positions, first, count, start, seen, rotation, covered, nullptr);
  } else {
    transform_with_states(chain, positions, first, count, start, seen, rotation, covered);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace abbe::chain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe::chain {

HWY_EXPORT(transform_block);

void transform_block(const CompiledChain& chain, const PositionArrays& positions, std::size_t first, std::size_t count,
                     const ConstPointArrays& start, const PointArrays& seen, const RotationArrays& rotation,
                     std::uint8_t* covered) {
  HWY_DYNAMIC_DISPATCH(transform_block)(chain, positions, first, count, start, seen, rotation, covered);
}

}  // namespace abbe::chain
#endif
