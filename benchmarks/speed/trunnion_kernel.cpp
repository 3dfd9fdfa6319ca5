#include "trunnion_kernel.h"

#include "abbe/errors/chain_kernel_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "speed/trunnion_kernel.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include "abbe/errors/chain_kernel_inline.h"

HWY_BEFORE_NAMESPACE();
namespace abbe::benchmarks {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using namespace abbe::chain::HWY_NAMESPACE;

struct Pose {
  Vector3 point, x, y;  ///< the point and two columns of the rotation
};

HWY_INLINE void turn_all(const ErrorTurns<Shears>& e, Pose& m) {
  for (Vector3* v : {&m.point, &m.x, &m.y}) turn(e.a, v->y, v->z);
  for (Vector3* v : {&m.point, &m.x, &m.y}) turn(e.b, v->z, v->x);
  for (Vector3* v : {&m.point, &m.x, &m.y}) turn(e.c, v->x, v->y);
}
HWY_INLINE void turn_all_back(const ErrorTurns<Shears>& e, Pose& m) {
  for (Vector3* v : {&m.point, &m.x, &m.y}) turn_back(e.c, v->x, v->y);
  for (Vector3* v : {&m.point, &m.x, &m.y}) turn_back(e.b, v->z, v->x);
  for (Vector3* v : {&m.point, &m.x, &m.y}) turn_back(e.a, v->y, v->z);
}

/// Poses between the evaluation of all errors, whose coefficients stay in registers, and the way through all axes,
/// whose state does. Few enough that the errors stay in the first-level cache.
constexpr std::size_t kAtOnce = 32;

struct Errors {
  Lane argument;
  Lane sine[2], cosine[2];  ///< C A
  Lane error[5][6];         ///< C A X Y Z
};

void evaluate_errors(const TrunnionNumbers& n, const double* const* commands, std::size_t first, Errors& e) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    for (std::size_t k = 0; k < kAtOnce; k += hn::Lanes(Tag())) {
      const SineCosine one = sine_cosine(hn::LoadU(Tag(), commands[axis] + first + k));
      store(one.sine, e.sine[axis].v + k);
      store(one.cosine, e.cosine[axis].v + k);
    }
    for (int c = 0; c < 6; ++c) {
      evaluate_harmonic_powers<4>(n.fourier[axis][c], e.cosine[axis], e.sine[axis], kAtOnce, false, e.error[axis][c]);
    }
  }
  for (std::size_t axis = 2; axis < 5; ++axis) {
    for (std::size_t k = 0; k < kAtOnce; k += hn::Lanes(Tag())) {
      store(hn::Mul(hn::LoadU(Tag(), commands[axis] + first + k), set(1.0 / 300)), e.argument.v + k);
    }
    for (int c = 0; c < 6; ++c) {
      evaluate_powers<5>(n.legendre[axis - 2][c], e.argument, kAtOnce, false, e.error[axis][c]);
    }
  }
}

HWY_INLINE void linear_axis(const TrunnionNumbers& n, int axis, Vector q, const Errors& errors, std::size_t k,
                            Pose& m) {
  const Vector3 shift = load(errors.error[axis], k);
  turn_all(error_shears(load(errors.error[axis] + 3, k)), m);
  const double* u = n.direction[axis];
  m.point = {hn::MulAdd(q, set(u[0]), hn::Add(m.point.x, shift.x)),
             hn::MulAdd(q, set(u[1]), hn::Add(m.point.y, shift.y)),
             hn::MulAdd(q, set(u[2]), hn::Add(m.point.z, shift.z))};
}

HWY_INLINE void inverted_rotary_axis(const TrunnionNumbers& n, int axis, const Errors& errors, std::size_t k, Pose& m) {
  const SineCosine one{load(errors.sine[axis].v + k), load(errors.cosine[axis].v + k)};
  const Vector3 reference = set3(n.reference[axis]), centre = set3(n.centre[axis]);
  m.point = m.point - reference - load(errors.error[axis], k);
  turn_all_back(error_shears(load(errors.error[axis] + 3, k)), m);
  m.point = m.point + reference - centre;
  // Primed and inverted: the displacement is + q.
  const double* u = n.direction[axis];
  const double* p = n.products[axis];
  const Vector rest = hn::Sub(set(1.0), one.cosine), c = one.cosine;
  const Vector xs = hn::Mul(set(u[0]), one.sine), ys = hn::Mul(set(u[1]), one.sine), zs = hn::Mul(set(u[2]), one.sine);
  const Vector xy = set(p[3]), xz = set(p[4]), yz = set(p[5]);
  const Matrix3 r = {{hn::MulAdd(rest, set(p[0]), c), hn::MulSub(rest, xy, zs), hn::MulAdd(rest, xz, ys)},
                     {hn::MulAdd(rest, xy, zs), hn::MulAdd(rest, set(p[1]), c), hn::MulSub(rest, yz, xs)},
                     {hn::MulSub(rest, xz, ys), hn::MulAdd(rest, yz, xs), hn::MulAdd(rest, set(p[2]), c)}};
  m.point = times_plus(r, m.point, centre);
  m.x = times(r, m.x);
  m.y = times(r, m.y);
}

void TransformTrunnion(const TrunnionNumbers& n, const double* const* commands, const double* const* start,
                       double* const* seen, std::size_t count) {
  const Tag d;
  Errors errors;
  const Vector zero = hn::Zero(d), one = set(1.0);
  for (std::size_t first = 0; first < count; first += kAtOnce) {
    evaluate_errors(n, commands, first, errors);
    for (std::size_t k = 0; k < kAtOnce; k += hn::Lanes(d)) {
      const std::size_t at = first + k;
      Pose m{{hn::LoadU(d, start[0] + at), hn::LoadU(d, start[1] + at), hn::LoadU(d, start[2] + at)},
             {one, zero, zero},
             {zero, one, zero}};
      m.point = m.point + set3(n.tool_reference);
      for (int axis = 4; axis > 1; --axis) linear_axis(n, axis, hn::LoadU(d, commands[axis] + at), errors, k, m);
      inverted_rotary_axis(n, 1, errors, k, m);
      inverted_rotary_axis(n, 0, errors, k, m);
      m.point = m.point - set3(n.workpiece);
      const Vector3 z = cross(m.x, m.y);
      const Vector out[12] = {m.point.x, m.point.y, m.point.z, m.x.x, m.y.x, z.x, m.x.y, m.y.y, z.y, m.x.z, m.y.z, z.z};
      for (int i = 0; i < 12; ++i) hn::StoreU(out[i], d, seen[i] + at);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace abbe::benchmarks
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "abbe/geometry/rotation.h"

namespace abbe::benchmarks {

TrunnionNumbers::TrunnionNumbers(const FiveAxisCase& five_axis) {
  const Machine& machine = five_axis.machine;
  for (const ErrorMotion& motion : five_axis.errors.motions) {
    const int c = static_cast<int>(motion.component);
    const std::vector<double>& a = motion.coefficients;
    if (motion.axis < 2) {
      const double* h = a.data();  // mean, cos1, sin1, ...
      const double powers[9] = {h[0] - h[3] + h[7],
                                h[1] - 3 * h[5],
                                2 * h[3] - 8 * h[7],
                                4 * h[5],
                                8 * h[7],
                                h[2] - h[6],
                                2 * h[4] - 4 * h[8],
                                4 * h[6],
                                8 * h[8]};
      std::copy(powers, powers + 9, fourier[motion.axis][c]);
    } else {
      double* p = legendre[motion.axis - 2][c];
      p[0] = a[0] - a[2] / 2 + 3 * a[4] / 8;
      p[1] = a[1] - 3 * a[3] / 2;
      p[2] = 3 * a[2] / 2 - 30 * a[4] / 8;
      p[3] = 5 * a[3] / 2;
      p[4] = 35 * a[4] / 8;
    }
  }
  for (std::size_t i = 0; i < 5; ++i) {
    Eigen::Vector3d tilt = Eigen::Vector3d::Zero(), point = machine.axes[i].point;
    for (const LocationError& location : five_axis.errors.locations) {
      if (location.axis != i) continue;
      (is_rotation(location.component) ? tilt : point)[static_cast<int>(location.component) % 3] += location.value;
    }
    const Eigen::Vector3d u = rotation_from_error_angles(tilt) * machine.axes[i].direction;
    for (int k = 0; k < 3; ++k) direction[i][k] = u[k];
    if (i >= 2) continue;
    const double p[6] = {u[0] * u[0], u[1] * u[1], u[2] * u[2], u[0] * u[1], u[0] * u[2], u[1] * u[2]};
    std::copy(p, p + 6, products[i]);
    for (int k = 0; k < 3; ++k) {
      centre[i][k] = point[k];
      reference[i][k] = machine.axes[i].point[k];
    }
  }
  for (int k = 0; k < 3; ++k) {
    tool_reference[k] = machine.tool_reference[k];
    workpiece[k] = machine.bed_from_workpiece.translation[k];
  }
}

HWY_EXPORT(TransformTrunnion);

void transform_trunnion(const TrunnionNumbers& numbers, const double* const* commands, const double* const* start,
                        double* const* seen, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(TransformTrunnion)(numbers, commands, start, seen, count);
}

}  // namespace abbe::benchmarks
#endif
