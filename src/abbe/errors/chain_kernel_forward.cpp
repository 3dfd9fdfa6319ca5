#include "abbe/errors/chain_kernel_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "abbe/errors/chain_kernel_forward.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include "abbe/errors/chain_kernel_inline.h"
#include "abbe/errors/chain_kernel_states_inline.h"

HWY_BEFORE_NAMESPACE();
namespace abbe::chain {
namespace HWY_NAMESPACE {
namespace {

/// Points and, in columns, the axes of the carried body, over the block. Of a rotation two columns suffice.
struct State {
  Lane point[3];
  Lane column[3][3];
};

/// The caller's arrays from the block's first pose on.
struct Results {
  double* point[3];
  double* column[3][3];
};

/// The state at one vector of poses.
template <int kColumns>
struct Moving {
  Vector3 point;
  Vector3 column[kColumns + 1];  // one too many: an array must not be empty
};

/// Error rotation of the point and the columns; angle by angle for all, so that independent operations follow each
/// other.
template <int kColumns>
HWY_INLINE void turn_all(const ErrorRotation& e, Moving<kColumns>& m) {
  turn(e.a, m.point.y, m.point.z);
  for (int i = 0; i < kColumns; ++i) turn(e.a, m.column[i].y, m.column[i].z);
  turn(e.b, m.point.z, m.point.x);
  for (int i = 0; i < kColumns; ++i) turn(e.b, m.column[i].z, m.column[i].x);
  turn(e.c, m.point.x, m.point.y);
  for (int i = 0; i < kColumns; ++i) turn(e.c, m.column[i].x, m.column[i].y);
}
template <int kColumns>
HWY_INLINE void turn_all_back(const ErrorRotation& e, Moving<kColumns>& m) {
  turn_back(e.c, m.point.x, m.point.y);
  for (int i = 0; i < kColumns; ++i) turn_back(e.c, m.column[i].x, m.column[i].y);
  turn_back(e.b, m.point.z, m.point.x);
  for (int i = 0; i < kColumns; ++i) turn_back(e.b, m.column[i].z, m.column[i].x);
  turn_back(e.a, m.point.y, m.point.z);
  for (int i = 0; i < kColumns; ++i) turn_back(e.a, m.column[i].y, m.column[i].z);
}

/// What the operations of a step are. Known to the compiler where it is the usual one, so that no vector asks.
struct StepShape {
  bool rotary, inverted, error_first, has_errors, has_angles, first_order;
};
StepShape shape_of(const AxisStep& step) {
  return {step.rotary, step.inverted, step.error_first, step.has_errors, step.has_angles, step.first_order};
}

/// @param kLarge  angles may be beyond the short series
template <int kColumns, bool kLarge>
HWY_INLINE void apply_error(const StepShape shape, const AxisStep& step, const AxisLanes& lanes, std::size_t k,
                            Moving<kColumns>& m) {
  const Vector3 shift = load(lanes.error, k);
  if (!shape.has_angles) {
    m.point = shape.inverted ? m.point - shift : m.point + shift;
    return;
  }
  const Vector3 reference = set3(step.reference), angles = load(lanes.error + 3, k);
  if (shape.first_order) {
    if (shape.inverted) {
      m.point = reference + first_order_inverse(angles, m.point - reference - shift);
      for (int i = 0; i < kColumns; ++i) m.column[i] = first_order_inverse(angles, m.column[i]);
    } else {
      m.point = m.point + shift + cross(angles, m.point - reference);
      for (int i = 0; i < kColumns; ++i) m.column[i] = m.column[i] + cross(angles, m.column[i]);
    }
    return;
  }
  const ErrorRotation e = kLarge ? error_rotation(angles) : short_error_rotation(angles);
  if (step.has_reference) m.point = m.point - reference;
  if (shape.inverted) {
    m.point = m.point - shift;
    turn_all_back(e, m);
  } else {
    turn_all(e, m);
    m.point = m.point + shift;
  }
  if (step.has_reference) m.point = m.point + reference;
}

template <int kColumns>
HWY_INLINE void apply_motion(const StepShape shape, const AxisStep& step, const AxisLanes& lanes, std::size_t k,
                             Moving<kColumns>& m) {
  if (!shape.rotary) {
    const Vector way = hn::Mul(hn::Add(load(lanes.position.v + k), set(step.zero_position)), set(step.sign));
    m.point = {hn::MulAdd(way, set(step.direction[0]), m.point.x), hn::MulAdd(way, set(step.direction[1]), m.point.y),
               hn::MulAdd(way, set(step.direction[2]), m.point.z)};
    return;
  }
  const SineCosine angle = motion_angle(step, {load(lanes.sine.v + k), load(lanes.cosine.v + k)});
  const Matrix3 r = rotation(step, angle);
  const Vector3 centre = set3(step.centre);
  m.point = times(r, m.point - centre) + centre;
  for (int i = 0; i < kColumns; ++i) m.column[i] = times(r, m.column[i]);
}

template <int kColumns>
HWY_INLINE Moving<kColumns> moving_at(const State& state, std::size_t k) {
  Moving<kColumns> m;
  m.point = load(state.point, k);
  for (int i = 0; i < kColumns; ++i) m.column[i] = load(state.column[i], k);
  return m;
}
template <int kColumns>
HWY_INLINE void keep(const Moving<kColumns>& m, State& state, std::size_t k) {
  store(m.point, state.point, k);
  for (int i = 0; i < kColumns; ++i) store(m.column[i], state.column[i], k);
}

/// One vector of poses.
template <int kColumns, bool kLarge>
HWY_INLINE void pass_vector(const StepShape shape, const AxisStep& step, const AxisLanes& lanes, std::size_t k,
                            State& state) {
  Moving<kColumns> m = moving_at<kColumns>(state, k);
  if (shape.has_errors && shape.error_first) apply_error<kColumns, kLarge>(shape, step, lanes, k, m);
  apply_motion(shape, step, lanes, k, m);
  if (shape.has_errors && !shape.error_first) apply_error<kColumns, kLarge>(shape, step, lanes, k, m);
  keep(m, state, k);
}

template <int kColumns>
HWY_NOINLINE void pass_large_angles(const AxisStep& step, const AxisLanes& lanes, std::size_t k, State& state) {
  pass_vector<kColumns, true>(shape_of(step), step, lanes, k, state);
}

template <int kColumns>
HWY_INLINE void pass_shape(const StepShape shape, const AxisStep& step, const AxisLanes& lanes, std::size_t end,
                           State& state) {
  const bool turns = shape.has_errors && shape.has_angles && !shape.first_order;
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    // Apart, so that what is rare costs the rest no registers.
    if (turns && HWY_UNLIKELY(has_large_angles(load(lanes.error + 3, k)))) {
      pass_large_angles<kColumns>(step, lanes, k, state);
    } else {
      pass_vector<kColumns, false>(shape, step, lanes, k, state);
    }
  }
}
template <int kColumns>
HWY_NOINLINE void pass_any_axis(const AxisStep& step, const AxisLanes& lanes, std::size_t end, State& state) {
  pass_shape<kColumns>(shape_of(step), step, lanes, end, state);
}
/// Errors with angles, composed exactly in the order of ISO 230-1.
template <int kColumns, bool kRotary, bool kInverted>
HWY_NOINLINE void pass_usual_axis(const AxisStep& step, const AxisLanes& lanes, std::size_t end, State& state) {
  constexpr StepShape kShape{kRotary, kInverted, kRotary == kInverted, true, true, false};
  pass_shape<kColumns>(kShape, step, lanes, end, state);
}

template <int kColumns>
HWY_INLINE void pass_axis(const AxisStep& step, const AxisLanes& lanes, std::size_t end, State& state) {
  const bool usual =
      step.has_errors && step.has_angles && !step.first_order && step.error_first == (step.rotary == step.inverted);
  if (!usual) {
    pass_any_axis<kColumns>(step, lanes, end, state);
  } else if (step.rotary) {
    step.inverted ? pass_usual_axis<kColumns, true, true>(step, lanes, end, state)
                  : pass_usual_axis<kColumns, true, false>(step, lanes, end, state);
  } else {
    step.inverted ? pass_usual_axis<kColumns, false, true>(step, lanes, end, state)
                  : pass_usual_axis<kColumns, false, false>(step, lanes, end, state);
  }
}

/// The same where location errors with states move the line.
template <int kColumns>
HWY_NOINLINE void pass_moving_axis(const AxisStep& step, const AxisLanes& lanes, const Lane* factor, std::size_t end,
                                   State& state) {
  LineLanes line;
  displace_lines(step, factor, end, line);
  const StepShape shape = shape_of(step);
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    Moving<kColumns> m = moving_at<kColumns>(state, k);
    if (step.has_errors && step.error_first) apply_error<kColumns, true>(shape, step, lanes, k, m);
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
    if (step.has_errors && !step.error_first) apply_error<kColumns, true>(shape, step, lanes, k, m);
    keep(m, state, k);
  }
}

/// @param first_column  of the rotation, the first that is carried
template <int kColumns>
HWY_NOINLINE void begin(const ConstantTransform& start, int first_column, std::size_t end, State& state) {
  const Matrix3 turn = set_matrix(start.rotation);
  const Vector3 offset = set3(start.offset);
  for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
    Vector3 p = load(state.point, k);
    if (start.turns) p = times(turn, p);
    store(p + offset, state.point, k);
    for (int i = 0; i < kColumns; ++i) {
      const double* r = start.rotation + first_column + i;
      store({set(r[0]), set(r[3]), set(r[6])}, state.column[i], k);
    }
  }
}

/// Where the results of a block go; whole vectors directly, what is left over one by one.
HWY_INLINE void write(Vector v, double* out, std::size_t k, std::size_t count) {
  if (HWY_LIKELY(k + hn::Lanes(Tag()) <= count)) {
    hn::StoreU(v, Tag(), out + k);
  } else {
    store_some(v, count - k, out + k);
  }
}
HWY_INLINE void write(const Vector3& v, double* const* out, std::size_t k, std::size_t count) {
  write(v.x, out[0], k, count);
  write(v.y, out[1], k, count);
  write(v.z, out[2], k, count);
}

template <int kColumns>
HWY_NOINLINE void finish(const ConstantTransform& last, const Results& results, std::size_t count, const State& state) {
  const Matrix3 turn = set_matrix(last.rotation);
  const Vector3 offset = set3(last.offset);
  for (std::size_t k = 0; k < count; k += hn::Lanes(Tag())) {
    Vector3 p = load(state.point, k);
    if (last.turns) p = times(turn, p);
    write(p + offset, results.point, k, count);
    if constexpr (kColumns > 0) {
      Vector3 column[3];
      for (int i = 0; i < kColumns; ++i) {
        column[i] = load(state.column[i], k);
        if (last.turns) column[i] = times(turn, column[i]);
      }
      if constexpr (kColumns == 2) column[2] = cross(column[0], column[1]);
      for (int i = 0; i < (kColumns == 1 ? 1 : 3); ++i) write(column[i], results.column[i], k, count);
    }
  }
}

template <int kColumns>
void run(const CompiledChain& chain, const PositionArrays& positions, std::size_t first, std::size_t count,
         const Results& results, State& state, AxisLanes& lanes, const Lane* factor, int alone = 0) {
  const std::size_t end = whole_vectors(count);
  begin<kColumns>(chain.start, alone, end, state);
  for (const AxisStep& step : chain.steps) {
    evaluate_axis(chain, step, positions.axis[step.axis] + first, count, lanes, factor);
    if (step.moving_line) {
      pass_moving_axis<kColumns>(step, lanes, factor, end, state);
    } else {
      pass_axis<kColumns>(step, lanes, end, state);
    }
  }
  finish<kColumns>(chain.end, results, count, state);
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
  State state;
  AxisLanes lanes;
  Results results{{seen.x + first, seen.y + first, seen.z + first}, {}};
  const int alone = only_column(rotation);
  for (int i = 0; i < 9; ++i) {
    if (rotation.r[i] != nullptr) results.column[alone < 0 ? i % 3 : 0][i / 3] = rotation.r[i] + first;
  }
  read_lane(start.x + first, count, state.point[0]);
  read_lane(start.y + first, count, state.point[1]);
  read_lane(start.z + first, count, state.point[2]);
  if (alone >= 0) {
    run<1>(chain, positions, first, count, results, state, lanes, factor, alone);
  } else if (rotation.r[0] == nullptr) {
    run<0>(chain, positions, first, count, results, state, lanes, factor);
  } else if (chain.first_order) {
    run<3>(chain, positions, first, count, results, state, lanes, factor);
  } else {
    run<2>(chain, positions, first, count, results, state, lanes, factor);
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
