// The point and the columns of a rotation that a chain moves, from the caller's arrays to its results; compiled once
// per processor generation, after chain_kernel_inline.h.

#if defined(ABBE_ERRORS_CHAIN_KERNEL_MOVING_INLINE_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ERRORS_CHAIN_KERNEL_MOVING_INLINE_H_
#undef ABBE_ERRORS_CHAIN_KERNEL_MOVING_INLINE_H_
#else
#define ABBE_ERRORS_CHAIN_KERNEL_MOVING_INLINE_H_
#endif

#include "abbe/errors/chain_kernel_inline.h"

HWY_BEFORE_NAMESPACE();
namespace abbe::chain {
namespace HWY_NAMESPACE {

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
template <int kColumns, class Turn>
HWY_INLINE void turn_all(const ErrorTurns<Turn>& e, Moving<kColumns>& m) {
  turn(e.a, m.point.y, m.point.z);
  for (int i = 0; i < kColumns; ++i) turn(e.a, m.column[i].y, m.column[i].z);
  turn(e.b, m.point.z, m.point.x);
  for (int i = 0; i < kColumns; ++i) turn(e.b, m.column[i].z, m.column[i].x);
  turn(e.c, m.point.x, m.point.y);
  for (int i = 0; i < kColumns; ++i) turn(e.c, m.column[i].x, m.column[i].y);
}
template <int kColumns, class Turn>
HWY_INLINE void turn_all_back(const ErrorTurns<Turn>& e, Moving<kColumns>& m) {
  turn_back(e.c, m.point.x, m.point.y);
  for (int i = 0; i < kColumns; ++i) turn_back(e.c, m.column[i].x, m.column[i].y);
  turn_back(e.b, m.point.z, m.point.x);
  for (int i = 0; i < kColumns; ++i) turn_back(e.b, m.column[i].z, m.column[i].x);
  turn_back(e.a, m.point.y, m.point.z);
  for (int i = 0; i < kColumns; ++i) turn_back(e.a, m.column[i].y, m.column[i].z);
}

/// turn_all() where the columns were ex and ey before: they are only written, with half of the operations.
HWY_INLINE void turn_units(const ErrorTurns<Shears>& e, Moving<2>& m) {
  turn(e.a, m.point.y, m.point.z);
  turn(e.b, m.point.z, m.point.x);
  turn(e.c, m.point.x, m.point.y);
  const Vector one = set(1.0);
  Vector3& ex = m.column[0];
  ex.z = hn::Neg(e.b.sine);
  ex.x = hn::NegMulAdd(e.b.half_tangent, e.b.sine, one);
  ex.y = hn::Mul(e.c.sine, ex.x);
  ex.x = hn::NegMulAdd(e.c.half_tangent, ex.y, ex.x);
  Vector3& ey = m.column[1];
  ey.x = hn::Mul(e.b.sine, e.a.sine);
  ey.z = hn::NegMulAdd(e.b.half_tangent, ey.x, e.a.sine);
  ey.y = hn::NegMulAdd(e.a.half_tangent, e.a.sine, one);
  turn(e.c, ey.x, ey.y);
}

template <class Mask>
HWY_INLINE Vector3 choose(Mask mask, const Vector3& yes, const Vector3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}
template <class Mask, int kColumns>
HWY_INLINE void choose(Mask mask, const Moving<kColumns>& yes, Moving<kColumns>& m) {
  m.point = choose(mask, yes.point, m.point);
  for (int i = 0; i < kColumns; ++i) m.column[i] = choose(mask, yes.column[i], m.column[i]);
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

/// Where a block begins and ends: the first step reads the caller's points and the last one writes the results, vector
/// by vector, so that their way to memory is hidden behind the operations of the steps.
struct Ends {
  std::size_t count;               ///< poses
  const ConstantTransform* start;  ///< null: not the first step
  const ConstantTransform* end;    ///< null: not the last step
  ConstPointArrays from;
  int first_column;  ///< of the rotation, the first that is carried
  Results results;
};

/// The same numbers of the ends as vectors, made once before a loop like StepVectors.
struct EndVectors {
  Vector3 start_offset, end_offset;  ///< of the chain, mm
  bool end_turns;                    ///< whether the chain ends with a rotation
};
HWY_INLINE EndVectors vectors_of(const Ends& ends) {
  return {.start_offset = ends.start != nullptr ? set3(ends.start->offset) : zero3(),
          .end_offset = ends.end != nullptr ? set3(ends.end->offset) : zero3(),
          .end_turns = ends.end != nullptr && ends.end->turns};
}

/// Whether a step is the first one and the columns before it are ex and ey.
template <int kColumns>
HWY_INLINE bool begins_with_units(const Ends& ends) {
  return kColumns == 2 && ends.start != nullptr && !ends.start->turns;
}
template <int kColumns>
HWY_INLINE void begin_columns(const Ends& ends, std::size_t k, State& state) {
  for (int i = 0; i < kColumns; ++i) {
    const double* r = ends.start->rotation + ends.first_column + i;
    store({set(r[0]), set(r[3]), set(r[6])}, state.column[i], k);
  }
}
/// The caller's points in the machine frame with all axes at zero, mm.
/// @param turns  whether the chain starts with a rotation
HWY_INLINE Vector3 first_point(const Ends& ends, const EndVectors& vectors, std::size_t k, bool turns) {
  Vector3 p = {read(ends.from.x, k, ends.count), read(ends.from.y, k, ends.count), read(ends.from.z, k, ends.count)};
  if (turns) p = times(set_matrix(ends.start->rotation), p);
  return p + vectors.start_offset;
}
template <int kColumns>
HWY_INLINE void begin_vector(const Ends& ends, std::size_t k, State& state) {
  if (ends.start == nullptr) return;
  store(first_point(ends, vectors_of(ends), k, ends.start->turns), state.point, k);
  begin_columns<kColumns>(ends, k, state);
}

struct WriteWhole {
  HWY_INLINE void operator()(Vector v, double* out) const { hn::StoreU(v, Tag(), out); }
};
/// The first values of a vector only.
struct WriteSome {
  std::size_t number;
  HWY_INLINE void operator()(Vector v, double* out) const { store_some(v, number, out); }
};

template <int kColumns, class Write>
HWY_INLINE void write_results(const Ends& ends, const EndVectors& vectors, std::size_t k, const Moving<kColumns>& m,
                              Write write) {
  const auto write3 = [&](const Vector3& v, double* const* out) HWY_ATTR {
    write(v.x, out[0] + k);
    write(v.y, out[1] + k);
    write(v.z, out[2] + k);
  };
  Vector3 p = m.point;
  if (vectors.end_turns) p = times(set_matrix(ends.end->rotation), p);
  write3(p + vectors.end_offset, ends.results.point);
  if constexpr (kColumns > 0) {
    Vector3 column[3];
    for (int i = 0; i < kColumns; ++i) {
      column[i] = m.column[i];
      if (vectors.end_turns) column[i] = times(set_matrix(ends.end->rotation), column[i]);
    }
    if constexpr (kColumns == 2) column[2] = cross(column[0], column[1]);
    for (int i = 0; i < (kColumns == 1 ? 1 : 3); ++i) write3(column[i], ends.results.column[i]);
  }
}
template <int kColumns>
HWY_NOINLINE void finish_last_vector(const Ends& ends, std::size_t k, const State& state) {
  write_results<kColumns>(ends, vectors_of(ends), k, moving_at<kColumns>(state, k), WriteSome{ends.count - k});
}
template <int kColumns>
HWY_INLINE void finish_vector(const Ends& ends, std::size_t k, const State& state) {
  if (ends.end == nullptr) return;
  if (HWY_LIKELY(k + hn::Lanes(Tag()) <= ends.count)) {
    write_results<kColumns>(ends, vectors_of(ends), k, moving_at<kColumns>(state, k), WriteWhole());
  } else {
    finish_last_vector<kColumns>(ends, k, state);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe::chain
HWY_AFTER_NAMESPACE();

#endif  // per target
