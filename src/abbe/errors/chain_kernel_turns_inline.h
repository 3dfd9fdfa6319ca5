// Vectors of poses and their rotations, compiled once per processor generation (no #pragma once: Highway includes this
// file again for each target).

#include <cstddef>

#include "abbe/errors/chain_kernel.h"
#include "hwy/highway.h"

#if defined(ABBE_ERRORS_CHAIN_KERNEL_TURNS_INLINE_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ERRORS_CHAIN_KERNEL_TURNS_INLINE_H_
#undef ABBE_ERRORS_CHAIN_KERNEL_TURNS_INLINE_H_
#else
#define ABBE_ERRORS_CHAIN_KERNEL_TURNS_INLINE_H_
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

/// One value per pose of the block; whole vectors are read and written. Longer than the block, so that the same pose
/// of several lanes does not lie at multiples of 4096 bytes: processors take such addresses for the same at first.
struct alignas(128) Lane {
  double v[kBlock + 16];
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

/// Sines and cosines, absolute error below 2e-16 for |x| up to 1e6 rad.
///
/// Every operation is done for all vectors before the next one, which depends on it, so the processor waits less.
/// Reduction by pi/2 in two parts of 53 bits, whose products a fused operation rounds once; without one, in three parts
/// of 33 bits, whose products are exact. Polynomials of degree 13 and 14 on |r| <= pi/4. Source: the argument reduction
/// of Cody and Waite (1980); coefficients of fdlibm.
///
/// @param x       [kNumber] rad
/// @param result  [kNumber]
template <int kNumber>
HWY_INLINE void sines_cosines(const Vector* x, SineCosine* result) {
  const Tag d;
  const IndexTag di;
  using Several = Vector[kNumber];
  const auto each = [](auto function) HWY_ATTR {
    for (int i = 0; i < kNumber; ++i) function(i);
  };
  // Adding 1.5 * 2^52 rounds to a whole number and leaves it in the low bits; cheap on every processor.
  const Vector rounder = set(6755399441055744.0);
  Several rounded, n, r, z, zz, s, c;
  each([&](int i) HWY_ATTR { rounded[i] = hn::MulAdd(x[i], set(6.36619772367581382433e-01), rounder); });
  each([&](int i) HWY_ATTR { n[i] = hn::Sub(rounded[i], rounder); });
  if constexpr (HWY_NATIVE_FMA) {
    each([&](int i) HWY_ATTR { r[i] = hn::NegMulAdd(n[i], set(0x1.921fb54442d18p+0), x[i]); });
    each([&](int i) HWY_ATTR { r[i] = hn::NegMulAdd(n[i], set(0x1.1a62633145c07p-54), r[i]); });
  } else {
    each([&](int i) HWY_ATTR { r[i] = hn::NegMulAdd(n[i], set(1.57079632673412561417e+00), x[i]); });
    each([&](int i) HWY_ATTR { r[i] = hn::NegMulAdd(n[i], set(6.07710050630396597660e-11), r[i]); });
    each([&](int i) HWY_ATTR { r[i] = hn::NegMulAdd(n[i], set(2.02226624879595063154e-21), r[i]); });
  }
  each([&](int i) HWY_ATTR { z[i] = hn::Mul(r[i], r[i]); });
  // Pairs of terms first: a chain of all terms would be longer than what the processor can overlap.
  each([&](int i) HWY_ATTR { zz[i] = hn::Mul(z[i], z[i]); });
  const auto pairs = [&](Vector* sum, double c0, double c1, double c2, double c3, double c4, double c5) HWY_ATTR {
    Several low, middle;
    each([&](int i) HWY_ATTR { sum[i] = hn::MulAdd(z[i], set(c5), set(c4)); });
    each([&](int i) HWY_ATTR { middle[i] = hn::MulAdd(z[i], set(c3), set(c2)); });
    each([&](int i) HWY_ATTR { low[i] = hn::MulAdd(z[i], set(c1), set(c0)); });
    each([&](int i) HWY_ATTR { sum[i] = hn::MulAdd(zz[i], sum[i], middle[i]); });
    each([&](int i) HWY_ATTR { sum[i] = hn::MulAdd(zz[i], sum[i], low[i]); });
  };
  pairs(s, -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04,
        2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10);
  each([&](int i) HWY_ATTR { s[i] = hn::MulAdd(hn::Mul(z[i], r[i]), s[i], r[i]); });
  pairs(c, 4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05,
        -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11);
  each([&](int i) HWY_ATTR { c[i] = hn::MulAdd(zz[i], c[i], hn::MulAdd(z[i], set(-0.5), set(1.0))); });
  each([&](int i) HWY_ATTR {
    const auto quadrant = hn::BitCast(di, rounded[i]);
    // Bits are exchanged in odd quadrants by exclusive or: a choice by mask costs three operations with AVX2.
    const Vector odd = hn::BitCast(d, hn::Neg(hn::And(quadrant, hn::Set(di, 1))));
    const Vector other = hn::And(hn::Xor(s[i], c[i]), odd), sign = hn::SignBit(d);
    const Vector sine_sign = hn::And(hn::BitCast(d, hn::ShiftLeft<62>(quadrant)), sign);
    const Vector cosine_sign = hn::Xor(sine_sign, hn::And(odd, sign));
    result[i] = {hn::Xor(hn::Xor(s[i], other), sine_sign), hn::Xor(hn::Xor(c[i], other), cosine_sign)};
  });
}
/// The same for one vector.
HWY_INLINE SineCosine sine_cosine(Vector x) {
  SineCosine result;
  sines_cosines<1>(&x, &result);
  return result;
}

/// A turn by a small angle as three shears, u -= t v, v += s u, u -= t v: three multiply-adds instead of four
/// operations.
struct Shears {
  Vector half_tangent, sine;  ///< t, tangent of half the angle, and s
};
HWY_INLINE void turn(const Shears& a, Vector& u, Vector& v) {
  u = hn::NegMulAdd(a.half_tangent, v, u);
  v = hn::MulAdd(a.sine, u, v);
  u = hn::NegMulAdd(a.half_tangent, v, u);
}
HWY_INLINE void turn_back(const Shears& a, Vector& u, Vector& v) {
  u = hn::MulAdd(a.half_tangent, v, u);
  v = hn::NegMulAdd(a.sine, u, v);
  u = hn::MulAdd(a.half_tangent, v, u);
}

/// Of E = Rz(EC) Ry(EB) Rx(EA).
template <class Turn>
struct ErrorTurns {
  Turn a, b, c;  ///< by EA, EB, EC
};
using ErrorRotation = ErrorTurns<SineCosine>;

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
/// Poses whose angles are too large for error_shears().
HWY_INLINE auto are_large(const Vector3& half_angles) {
  const Vector3 z = squares_of(half_angles);
  return hn::Ge(hn::Add(hn::Add(z.x, z.y), z.z), set(0x1p-22));
}
/// Series for angles below 1/1024 rad (next terms below 1e-17), from half the angle h and its square: h + h^3 / 3 and
/// 2 h - 4 h^3 / 3.
HWY_INLINE Shears short_shears(Vector h, Vector z) {
  const Vector cube = hn::Mul(h, z);
  return {hn::MulAdd(cube, set(1.0 / 3), h), hn::MulAdd(cube, set(-4.0 / 3), hn::Add(h, h))};
}
HWY_INLINE ErrorTurns<Shears> error_shears(const Vector3& half_angles) {
  const Vector3 z = squares_of(half_angles);
  return {short_shears(half_angles.x, z.x), short_shears(half_angles.y, z.y), short_shears(half_angles.z, z.z)};
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
/// Their product plus b.
HWY_INLINE Vector3 times_plus(const Matrix3& m, const Vector3& a, const Vector3& b) {
  return {hn::MulAdd(m.x.x, a.x, hn::MulAdd(m.x.y, a.y, hn::MulAdd(m.x.z, a.z, b.x))),
          hn::MulAdd(m.y.x, a.x, hn::MulAdd(m.y.y, a.y, hn::MulAdd(m.y.z, a.z, b.y))),
          hn::MulAdd(m.z.x, a.x, hn::MulAdd(m.z.y, a.y, hn::MulAdd(m.z.z, a.z, b.z)))};
}
HWY_INLINE Vector3 transposed_times(const Matrix3& m, const Vector3& a) {
  return {hn::MulAdd(m.x.x, a.x, hn::MulAdd(m.y.x, a.y, hn::Mul(m.z.x, a.z))),
          hn::MulAdd(m.x.y, a.x, hn::MulAdd(m.y.y, a.y, hn::Mul(m.z.y, a.z))),
          hn::MulAdd(m.x.z, a.x, hn::MulAdd(m.y.z, a.y, hn::Mul(m.z.z, a.z)))};
}
HWY_INLINE Matrix3 set_matrix(const double* m) { return {set3(m), set3(m + 3), set3(m + 6)}; }

/// The numbers of an AxisStep that its motion needs, each broadcast to a vector.
///
/// Made once before a loop. Inside the loop they would be loaded and broadcast again for every vector, because the
/// compiler must assume that any store can change them.
struct StepVectors {
  Vector3 before, between, after;  ///< mm
  bool has_offsets;                ///< any of these is not zero
  Vector3 signed_direction;
  Vector xx, yy, zz, xy, xz, yz;  ///< AxisStep::direction_products
  Vector zero_position;           ///< mm or rad
  Vector zero_sine, zero_cosine;
};
HWY_INLINE StepVectors vectors_of(const AxisStep& step) {
  const double* product = step.direction_products;
  return {.before = set3(step.before),
          .between = set3(step.between),
          .after = set3(step.after),
          .has_offsets = step.has_offsets,
          .signed_direction = set3(step.signed_direction),
          .xx = set(product[0]),
          .yy = set(product[1]),
          .zz = set(product[2]),
          .xy = set(product[3]),
          .xz = set(product[4]),
          .yz = set(product[5]),
          .zero_position = set(step.zero_position),
          .zero_sine = set(step.zero_sine),
          .zero_cosine = set(step.zero_cosine)};
}

/// Rotation of a rotary axis about its displaced line by the angle times its sign.
HWY_INLINE Matrix3 rotation(const StepVectors& step, const SineCosine& a) {
  const Vector rest = hn::Sub(set(1.0), a.cosine);
  const Vector xs = hn::Mul(step.signed_direction.x, a.sine), ys = hn::Mul(step.signed_direction.y, a.sine);
  const Vector zs = hn::Mul(step.signed_direction.z, a.sine);
  // Products and sums apart: other units add than multiply.
  const Vector xy = hn::Mul(rest, step.xy), xz = hn::Mul(rest, step.xz), yz = hn::Mul(rest, step.yz);
  return {{hn::MulAdd(rest, step.xx, a.cosine), hn::Sub(xy, zs), hn::Add(xz, ys)},
          {hn::Add(xy, zs), hn::MulAdd(rest, step.yy, a.cosine), hn::Sub(yz, xs)},
          {hn::Sub(xz, ys), hn::Add(yz, xs), hn::MulAdd(rest, step.zz, a.cosine)}};
}

/// Sine and cosine of q + zero position from those of q.
HWY_INLINE SineCosine motion_angle(const StepVectors& step, const SineCosine& q) {
  return {hn::MulAdd(q.sine, step.zero_cosine, hn::Mul(q.cosine, step.zero_sine)),
          hn::NegMulAdd(q.sine, step.zero_sine, hn::Mul(q.cosine, step.zero_cosine))};
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe::chain
HWY_AFTER_NAMESPACE();

#endif  // per target
