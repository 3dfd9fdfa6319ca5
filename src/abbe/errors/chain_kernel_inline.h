// Error motions and rotations over a block of poses, compiled once per processor generation (no #pragma once: Highway
// includes this file again for each target).

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "abbe/errors/chain_kernel.h"
#include "hwy/highway.h"

#if defined(ABBE_ERRORS_CHAIN_KERNEL_INLINE_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ERRORS_CHAIN_KERNEL_INLINE_H_
#undef ABBE_ERRORS_CHAIN_KERNEL_INLINE_H_
#else
#define ABBE_ERRORS_CHAIN_KERNEL_INLINE_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace abbe::chain {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::ScalableTag<double>;
using Vector = hn::Vec<Tag>;
using IndexTag = hn::RebindToSigned<Tag>;

constexpr std::size_t kBlock = ChainPlan::kBlockSize;

HWY_INLINE Vector load(const double* p) { return hn::Load(Tag(), p); }
HWY_INLINE Vector set(double value) { return hn::Set(Tag(), value); }
HWY_INLINE void store(Vector v, double* p) { hn::Store(v, Tag(), p); }

/// One value per pose of the block; whole vectors are read and written.
struct alignas(128) Lane {
  double v[kBlock];
};

struct Vector3 {
  Vector x, y, z;
};

HWY_INLINE Vector3 load(const Lane* lanes, std::size_t k) {
  return {load(lanes[0].v + k), load(lanes[1].v + k), load(lanes[2].v + k)};
}
HWY_INLINE void store(const Vector3& a, Lane* lanes, std::size_t k) {
  store(a.x, lanes[0].v + k);
  store(a.y, lanes[1].v + k);
  store(a.z, lanes[2].v + k);
}
HWY_INLINE Vector3 set3(const double* p) { return {set(p[0]), set(p[1]), set(p[2])}; }
HWY_INLINE Vector3 operator+(const Vector3& a, const Vector3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Vector3 operator-(const Vector3& a, const Vector3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vector3 zero3() { return {set(0), set(0), set(0)}; }
HWY_INLINE Vector3 negative(const Vector3& a) { return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)}; }
HWY_INLINE Vector3 cross(const Vector3& a, const Vector3& b) {
  return {hn::NegMulAdd(a.z, b.y, hn::Mul(a.y, b.z)), hn::NegMulAdd(a.x, b.z, hn::Mul(a.z, b.x)),
          hn::NegMulAdd(a.y, b.x, hn::Mul(a.x, b.y))};
}
HWY_INLINE Vector dot(const Vector3& a, const Vector3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

struct SineCosine {
  Vector sine, cosine;
};

/// (u, v) turned by the angle: (u cos - v sin, u sin + v cos); towards -: by the negative angle.
HWY_INLINE void turn(const SineCosine& a, Vector& u, Vector& v) {
  const Vector old = u;
  u = hn::NegMulAdd(v, a.sine, hn::Mul(u, a.cosine));
  v = hn::MulAdd(old, a.sine, hn::Mul(v, a.cosine));
}
HWY_INLINE void turn_back(const SineCosine& a, Vector& u, Vector& v) {
  const Vector old = u;
  u = hn::MulAdd(v, a.sine, hn::Mul(u, a.cosine));
  v = hn::NegMulAdd(old, a.sine, hn::Mul(v, a.cosine));
}

/// Sine and cosine, absolute error below 2e-16 for |x| up to 1e6 rad.
///
/// Reduction by pi/2 in three parts of 33 bits, so that the products are exact without FMA too; polynomials of
/// degree 13 and 14 on |r| <= pi/4. Source: the argument reduction of Cody and Waite (1980); coefficients of fdlibm.
HWY_INLINE SineCosine sine_cosine(Vector x) {
  const Tag d;
  const IndexTag di;
  // Adding 1.5 * 2^52 rounds to a whole number and leaves it in the low bits; cheap on every processor.
  const Vector rounder = set(6755399441055744.0);
  const Vector rounded = hn::MulAdd(x, set(6.36619772367581382433e-01), rounder);
  const Vector n = hn::Sub(rounded, rounder);
  Vector r = hn::NegMulAdd(n, set(1.57079632673412561417e+00), x);
  r = hn::NegMulAdd(n, set(6.07710050630396597660e-11), r);
  r = hn::NegMulAdd(n, set(2.02226624879595063154e-21), r);
  const Vector z = hn::Mul(r, r);
  Vector s = hn::MulAdd(z, set(1.58969099521155010221e-10), set(-2.50507602534068634195e-08));
  s = hn::MulAdd(z, s, set(2.75573137070700676789e-06));
  s = hn::MulAdd(z, s, set(-1.98412698298579493134e-04));
  s = hn::MulAdd(z, s, set(8.33333333332248946124e-03));
  s = hn::MulAdd(z, s, set(-1.66666666666666324348e-01));
  s = hn::MulAdd(hn::Mul(z, r), s, r);
  Vector c = hn::MulAdd(z, set(-1.13596475577881948265e-11), set(2.08757232129817482790e-09));
  c = hn::MulAdd(z, c, set(-2.75573143513906633035e-07));
  c = hn::MulAdd(z, c, set(2.48015872894767294178e-05));
  c = hn::MulAdd(z, c, set(-1.38888888888741095749e-03));
  c = hn::MulAdd(z, c, set(4.16666666666666019037e-02));
  const Vector one = set(1.0), half = hn::Mul(z, set(0.5)), w = hn::Sub(one, half);
  c = hn::Add(w, hn::MulAdd(hn::Mul(z, z), c, hn::Sub(hn::Sub(one, w), half)));
  const auto quadrant = hn::BitCast(di, rounded);
  const auto odd = hn::MaskFromVec(hn::BitCast(d, hn::Neg(hn::And(quadrant, hn::Set(di, 1)))));
  const Vector sign = hn::SignBit(d);
  const Vector sine_sign = hn::And(hn::BitCast(d, hn::ShiftLeft<62>(quadrant)), sign);
  const Vector cosine_sign = hn::And(hn::BitCast(d, hn::ShiftLeft<62>(hn::Add(quadrant, hn::Set(di, 1)))), sign);
  return {hn::Xor(hn::IfThenElse(odd, c, s), sine_sign), hn::Xor(hn::IfThenElse(odd, s, c), cosine_sign)};
}

/// Of E = Rz(EC) Ry(EB) Rx(EA).
struct ErrorRotation {
  SineCosine a, b, c;  ///< of EA, EB, EC
};

/// Series for angles below 1/256 rad (next terms below 5e-18), from the angle and its square.
HWY_INLINE SineCosine short_sine_cosine(Vector x, Vector z) {
  const Vector s = hn::MulAdd(z, set(1.0 / 120), set(-1.0 / 6));
  const Vector c = hn::MulAdd(z, set(1.0 / 24), set(-0.5));
  return {hn::MulAdd(hn::Mul(x, z), s, x), hn::MulAdd(z, c, set(1.0))};
}
template <class Mask>
HWY_INLINE SineCosine choose(Mask large, const SineCosine& yes, const SineCosine& no) {
  return {hn::IfThenElse(large, yes.sine, no.sine), hn::IfThenElse(large, yes.cosine, no.cosine)};
}
/// Full range where the three angles are not small together; decided per pose, so that a result does not depend on its
/// neighbours.
inline HWY_NOINLINE ErrorRotation with_large_angles(const Vector3& angles, const Vector3& squares, ErrorRotation e) {
  const Vector sum = hn::Add(hn::Add(squares.x, squares.y), squares.z);
  const auto large = hn::Ge(sum, set(0x1p-16));
  e.a = choose(large, sine_cosine(angles.x), e.a);
  e.b = choose(large, sine_cosine(angles.y), e.b);
  e.c = choose(large, sine_cosine(angles.z), e.c);
  return e;
}
HWY_INLINE Vector3 squares_of(const Vector3& a) { return {hn::Mul(a.x, a.x), hn::Mul(a.y, a.y), hn::Mul(a.z, a.z)}; }
/// Whether any pose of the vector needs the full range.
HWY_INLINE bool has_large_angles(const Vector3& angles) {
  const Vector3 z = squares_of(angles);
  return !hn::AllFalse(Tag(), hn::Ge(hn::Add(hn::Add(z.x, z.y), z.z), set(0x1p-16)));
}
HWY_INLINE ErrorRotation short_error_rotation(const Vector3& angles) {
  const Vector3 z = squares_of(angles);
  return {short_sine_cosine(angles.x, z.x), short_sine_cosine(angles.y, z.y), short_sine_cosine(angles.z, z.z)};
}
HWY_INLINE ErrorRotation error_rotation(const Vector3& angles) {
  const ErrorRotation e = short_error_rotation(angles);
  return HWY_UNLIKELY(has_large_angles(angles)) ? with_large_angles(angles, squares_of(angles), e) : e;
}
/// (I + skew(e))^-1 r, for the first-order composition of published models.
HWY_INLINE Vector3 first_order_inverse(const Vector3& e, const Vector3& r) {
  const Vector along = dot(e, r), scale = hn::Div(set(1.0), hn::Add(set(1.0), dot(e, e)));
  const Vector3 c = cross(e, r);
  return {hn::Mul(scale, hn::MulAdd(e.x, along, hn::Sub(r.x, c.x))),
          hn::Mul(scale, hn::MulAdd(e.y, along, hn::Sub(r.y, c.y))),
          hn::Mul(scale, hn::MulAdd(e.z, along, hn::Sub(r.z, c.z)))};
}

/// Rotation matrix, rows.
struct Matrix3 {
  Vector3 x, y, z;
};
HWY_INLINE Vector3 times(const Matrix3& m, const Vector3& a) { return {dot(m.x, a), dot(m.y, a), dot(m.z, a)}; }
HWY_INLINE Vector3 transposed_times(const Matrix3& m, const Vector3& a) {
  return {hn::MulAdd(m.x.x, a.x, hn::MulAdd(m.y.x, a.y, hn::Mul(m.z.x, a.z))),
          hn::MulAdd(m.x.y, a.x, hn::MulAdd(m.y.y, a.y, hn::Mul(m.z.y, a.z))),
          hn::MulAdd(m.x.z, a.x, hn::MulAdd(m.y.z, a.y, hn::Mul(m.z.z, a.z)))};
}
HWY_INLINE Matrix3 set_matrix(const double* m) { return {set3(m), set3(m + 3), set3(m + 6)}; }

/// Rotation of a rotary axis about its displaced line.
HWY_INLINE Matrix3 rotation(const AxisStep& step, const SineCosine& a) {
  const Vector rest = hn::Sub(set(1.0), a.cosine);
  const Vector xs = hn::Mul(set(step.direction[0]), a.sine);
  const Vector ys = hn::Mul(set(step.direction[1]), a.sine);
  const Vector zs = hn::Mul(set(step.direction[2]), a.sine);
  const Vector xy = set(step.direction_products[3]), xz = set(step.direction_products[4]);
  const Vector yz = set(step.direction_products[5]);
  return {
      {hn::MulAdd(rest, set(step.direction_products[0]), a.cosine), hn::MulSub(rest, xy, zs), hn::MulAdd(rest, xz, ys)},
      {hn::MulAdd(rest, xy, zs), hn::MulAdd(rest, set(step.direction_products[1]), a.cosine), hn::MulSub(rest, yz, xs)},
      {hn::MulSub(rest, xz, ys), hn::MulAdd(rest, yz, xs),
       hn::MulAdd(rest, set(step.direction_products[2]), a.cosine)}};
}

/// Sine and cosine of sign * (q + zero position) from those of q.
HWY_INLINE SineCosine motion_angle(const AxisStep& step, const SineCosine& q) {
  const Vector s0 = set(step.zero_sine), c0 = set(step.zero_cosine);
  return {hn::Mul(set(step.sign), hn::MulAdd(q.sine, c0, hn::Mul(q.cosine, s0))),
          hn::NegMulAdd(q.sine, s0, hn::Mul(q.cosine, c0))};
}

/// Commands of one axis over the block, and what its error motions and its motion are made of.
struct AxisLanes {
  Lane position;
  Lane sine, cosine;  ///< of the command, rotary axes only
  Lane error[6];      ///< EX .. EC, mm and rad
};

HWY_INLINE std::size_t whole_vectors(std::size_t count) {
  const std::size_t n = hn::Lanes(Tag());
  return (count + n - 1) / n * n;
}

/// Copies count values and fills up to whole vectors with the last one.
inline HWY_NOINLINE void read_lane(const double* from, std::size_t count, Lane& to) {
  std::memcpy(to.v, from, count * sizeof(double));
  for (std::size_t k = count; k < whole_vectors(count); ++k) to.v[k] = from[count - 1];
}

/// The first values of a vector only.
HWY_INLINE void store_some(Vector v, std::size_t number, double* out) {
  Lane tail;
  store(v, tail.v);
  std::memcpy(out, tail.v, number * sizeof(double));
}

/// Interval and local position (0 to 1) of pieces.
struct Piece {
  Vector index;  ///< a whole number
  Vector local;
  Vector inverse_length;  ///< 1 / mm or 1 / rad
};

HWY_INLINE hn::Vec<IndexTag> whole_index(Vector index) {
  // Adding 2^52 leaves a small whole number in the low bits; exact, and cheap on every processor.
  const IndexTag di;
  const auto bits = hn::BitCast(di, hn::Add(index, set(4503599627370496.0)));
  return hn::And(bits, hn::Set(di, 0xFFFFFFFFLL));
}

HWY_INLINE Piece find_piece(const FunctionGroup& group, const double* numbers, Vector q) {
  const Tag d;
  const Vector last = set(static_cast<double>(group.pieces - 1)), zero = hn::Zero(d);
  if (group.period > 0) {
    const Vector turns = hn::Floor(hn::Div(hn::Sub(q, set(group.start)), set(group.period)));
    q = hn::NegMulAdd(turns, set(group.period), q);
  }
  if (group.inverse_step > 0) {
    const Vector t = hn::Mul(hn::Sub(q, set(group.start)), set(group.inverse_step));
    // Min and Max order: a position that is no number must still give a valid index.
    const Vector index = hn::Max(hn::Min(hn::Floor(t), last), zero);
    const Vector safe = hn::IfThenElse(hn::Eq(t, t), index, zero);
    return {safe, hn::Sub(t, safe), set(group.inverse_step)};
  }
  const double* starts = numbers + group.breaks;
  std::size_t step = 1;
  while (step < group.pieces) step *= 2;
  Vector index = zero;
  for (step /= 2; step > 0; step /= 2) {
    const Vector candidate = hn::Min(hn::Add(index, set(static_cast<double>(step))), last);
    const Vector begin = hn::GatherIndex(d, starts, whole_index(candidate));
    index = hn::IfThenElse(hn::Le(begin, q), candidate, index);
  }
  const auto at = whole_index(index);
  const Vector inverse_length = hn::GatherIndex(d, starts + group.pieces, at);
  return {index, hn::Mul(hn::Sub(q, hn::GatherIndex(d, starts, at)), inverse_length), inverse_length};
}

template <std::size_t kVectors>
HWY_INLINE void add_to(double* out, bool add, const Vector* value) {
  for (std::size_t i = 0; i < kVectors; ++i) {
    double* p = out + i * hn::Lanes(Tag());
    store(add ? hn::Add(load(p), value[i]) : value[i], p);
  }
}

/// Horner with the number of coefficients known, so that nothing but multiply-adds is left.
template <std::size_t kVectors, std::size_t kSize>
HWY_INLINE void horner(const double* c, const Vector* s, Vector* value) {
  for (std::size_t i = 0; i < kVectors; ++i) value[i] = set(c[kSize - 1]);
  for (std::size_t n = kSize - 1; n-- > 0;) {
    for (std::size_t i = 0; i < kVectors; ++i) value[i] = hn::MulAdd(value[i], s[i], set(c[n]));
  }
}

template <std::size_t kVectors>
HWY_INLINE void clenshaw(const Series& series, const double* c, const Vector* s, Vector* value) {
  Vector before[kVectors];
  for (std::size_t i = 0; i < kVectors; ++i) {
    before[i] = hn::Zero(Tag());
    value[i] = set(c[series.size - 1]);
  }
  for (std::size_t n = series.size - 1; n-- > 0;) {
    for (std::size_t i = 0; i < kVectors; ++i) {
      const Vector twice = n > 0 ? hn::Add(s[i], s[i]) : s[i];
      const Vector next = hn::MulAdd(twice, value[i], hn::Sub(set(c[n]), before[i]));
      before[i] = value[i];
      value[i] = next;
    }
  }
}

/// kVectors vectors of poses from k on, all series of one group.
template <std::size_t kVectors>
inline HWY_NOINLINE void evaluate_polynomials(const FunctionGroup& group, const double* numbers, const AxisLanes& lanes,
                                              std::size_t k, unsigned written, Lane* out) {
  Vector s[kVectors], value[kVectors];
  for (std::size_t i = 0; i < kVectors; ++i) {
    s[i] = hn::Mul(hn::Sub(load(lanes.position.v + k + i * hn::Lanes(Tag())), set(group.centre)), set(group.scale));
  }
  for (const Series& series : group.series) {
    const double* c = numbers + series.first;
    if (group.form == Form::chebyshev) {
      clenshaw<kVectors>(series, c, s, value);
    } else {
      static_assert(kLargestPowerSize == 9);
      switch (series.size) {
        case 1:
          horner<kVectors, 1>(c, s, value);
          break;
        case 2:
          horner<kVectors, 2>(c, s, value);
          break;
        case 3:
          horner<kVectors, 3>(c, s, value);
          break;
        case 4:
          horner<kVectors, 4>(c, s, value);
          break;
        case 5:
          horner<kVectors, 5>(c, s, value);
          break;
        case 6:
          horner<kVectors, 6>(c, s, value);
          break;
        case 7:
          horner<kVectors, 7>(c, s, value);
          break;
        case 8:
          horner<kVectors, 8>(c, s, value);
          break;
        default:
          horner<kVectors, 9>(c, s, value);
          break;
      }
    }
    add_to<kVectors>(out[series.component].v + k, (written >> series.component & 1) != 0, value);
    written |= 1u << series.component;
  }
}

HWY_INLINE SineCosine fourier_argument(double scale, bool shares_turn, const AxisLanes& lanes, std::size_t k) {
  if (shares_turn) return {load(lanes.sine.v + k), load(lanes.cosine.v + k)};
  return sine_cosine(hn::Mul(load(lanes.position.v + k), set(scale)));
}

constexpr std::size_t kHarmonics = 4;  // computed at once

/// Their number is known, as that of the coefficients of horner().
template <std::size_t kVectors, std::size_t kNumber>
HWY_INLINE void add_harmonics(const double* pairs, const SineCosine (&harmonic)[kHarmonics][kVectors], Vector* value) {
  for (std::size_t h = 0; h < kNumber; ++h) {
    for (std::size_t i = 0; i < kVectors; ++i) {
      value[i] = hn::MulAdd(set(pairs[2 * h]), harmonic[h][i].cosine, value[i]);
      value[i] = hn::MulAdd(set(pairs[2 * h + 1]), harmonic[h][i].sine, value[i]);
    }
  }
}

template <std::size_t kVectors>
inline HWY_NOINLINE void evaluate_fourier(const FunctionGroup& group, const double* numbers, const AxisLanes& lanes,
                                          std::size_t k, unsigned written, Lane* out) {
  std::size_t most = 0;
  for (const Series& series : group.series) most = std::max(most, series.size);
  SineCosine one[kVectors], harmonic[kHarmonics][kVectors], last[kVectors];
  for (std::size_t i = 0; i < kVectors; ++i) {
    one[i] = last[i] = fourier_argument(group.scale, group.shares_turn, lanes, k + i * hn::Lanes(Tag()));
  }
  for (std::size_t first = 0; first == 0 || first < most; first += kHarmonics) {
    for (std::size_t h = 0; h < kHarmonics; ++h) {
      for (std::size_t i = 0; i < kVectors; ++i) {
        if (first + h > 0) turn(one[i], last[i].cosine, last[i].sine);
        harmonic[h][i] = last[i];
      }
    }
    for (const Series& series : group.series) {
      const double* c = numbers + series.first;
      Vector value[kVectors];
      for (std::size_t i = 0; i < kVectors; ++i) value[i] = first == 0 ? set(c[0]) : hn::Zero(Tag());
      const std::size_t end = series.size > first ? std::min(series.size - first, kHarmonics) : 0;
      const double* pairs = c + 2 * first + 1;
      switch (end) {
        case 1:
          add_harmonics<kVectors, 1>(pairs, harmonic, value);
          break;
        case 2:
          add_harmonics<kVectors, 2>(pairs, harmonic, value);
          break;
        case 3:
          add_harmonics<kVectors, 3>(pairs, harmonic, value);
          break;
        case kHarmonics:
          add_harmonics<kVectors, kHarmonics>(pairs, harmonic, value);
          break;
      }
      add_to<kVectors>(out[series.component].v + k, (written >> series.component & 1) != 0, value);
      written |= 1u << series.component;
    }
  }
}

inline HWY_NOINLINE void evaluate_pieces(const FunctionGroup& group, const double* numbers, const AxisLanes& lanes,
                                         std::size_t k, unsigned written, Lane* out) {
  const Tag d;
  const IndexTag di;
  const Piece piece = find_piece(group, numbers, load(lanes.position.v + k));
  const auto at = hn::ShiftLeft<2>(whole_index(piece.index));
  for (const Series& series : group.series) {
    const double* c = numbers + series.first;
    Vector value = hn::GatherIndex(d, c, hn::Add(at, hn::Set(di, 1)));
    if (!group.straight) {
      value = hn::MulAdd(hn::GatherIndex(d, c, hn::Add(at, hn::Set(di, 2))), piece.local, value);
      const Vector cube = hn::Mul(hn::GatherIndex(d, c, hn::Add(at, hn::Set(di, 3))), piece.local);
      value = hn::MulAdd(cube, piece.local, value);
    }
    value = hn::MulAdd(value, piece.local, hn::GatherIndex(d, c, at));
    add_to<1>(out[series.component].v + k, (written >> series.component & 1) != 0, &value);
    written |= 1u << series.component;
  }
}

/// All series of one group over the block.
HWY_INLINE void evaluate_group(const FunctionGroup& group, const double* numbers, const AxisLanes& lanes,
                               std::size_t end, unsigned written, Lane* out) {
  const std::size_t width = hn::Lanes(Tag());
  // Several vectors at a time hide the latency of the recurrences and share the coefficients, as many as registers
  // hold; the last ones go singly, with the same operations.
  std::size_t k = 0;
  if (group.form == Form::pieces) {
    for (; k < end; k += width) evaluate_pieces(group, numbers, lanes, k, written, out);
  } else if (group.form == Form::fourier) {
    for (; k + 2 * width <= end; k += 2 * width) evaluate_fourier<2>(group, numbers, lanes, k, written, out);
    for (; k < end; k += width) evaluate_fourier<1>(group, numbers, lanes, k, written, out);
  } else {
    for (; k + 8 * width <= end; k += 8 * width) evaluate_polynomials<8>(group, numbers, lanes, k, written, out);
    for (; k < end; k += width) evaluate_polynomials<1>(group, numbers, lanes, k, written, out);
  }
}

/// Adds the terms of a step that have states.
/// @param factor  [states of the chain]
inline HWY_NOINLINE void add_stated_errors(const CompiledChain& chain, const AxisStep& step, const Lane* factor,
                                           std::size_t end, AxisLanes& lanes) {
  Lane value[6];
  for (std::size_t g = step.plain_groups; g < step.groups.size(); ++g) {
    const FunctionGroup& group = step.groups[g];
    evaluate_group(group, chain.numbers.data(), lanes, end, 0, value);
    const double* by = factor[group.state].v;
    for (const Series& series : group.series) {
      double* sum = lanes.error[series.component].v;
      const double* added = value[series.component].v;
      for (std::size_t k = 0; k < end; k += hn::Lanes(Tag())) {
        store(hn::MulAdd(load(added + k), load(by + k), load(sum + k)), sum + k);
      }
    }
  }
}

/// Reads the commands of a step's axis and evaluates its error motions into lanes.error.
/// @param factor  of the states of the chain; null if it has none
inline HWY_NOINLINE void evaluate_axis(const CompiledChain& chain, const AxisStep& step, const double* commands,
                                       std::size_t count, AxisLanes& lanes, const Lane* factor) {
  const std::size_t width = hn::Lanes(Tag()), end = whole_vectors(count);
  read_lane(commands, count, lanes.position);
  if (step.rotary) {
    for (std::size_t k = 0; k < end; k += width) {
      const SineCosine turn_of_axis = sine_cosine(load(lanes.position.v + k));
      store(turn_of_axis.sine, lanes.sine.v + k);
      store(turn_of_axis.cosine, lanes.cosine.v + k);
    }
  }
  if (!step.has_errors) return;
  unsigned written = 0;
  for (std::size_t g = 0; g < step.plain_groups; ++g) {
    const FunctionGroup& group = step.groups[g];
    evaluate_group(group, chain.numbers.data(), lanes, end, written, lanes.error);
    for (const Series& series : group.series) written |= 1u << series.component;
  }
  for (int component = 0; component < 6; ++component) {
    if ((written >> component & 1) != 0) continue;
    for (std::size_t k = 0; k < end; k += width) store(hn::Zero(Tag()), lanes.error[component].v + k);
  }
  if (step.plain_groups < step.groups.size()) add_stated_errors(chain, step, factor, end, lanes);
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe::chain
HWY_AFTER_NAMESPACE();

#endif  // per target
