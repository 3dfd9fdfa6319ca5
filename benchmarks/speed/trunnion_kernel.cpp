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

HWY_INLINE void turn_all(const ErrorRotation& e, Pose& m) {
  for (Vector3* v : {&m.point, &m.x, &m.y}) turn(e.a, v->y, v->z);
  for (Vector3* v : {&m.point, &m.x, &m.y}) turn(e.b, v->z, v->x);
  for (Vector3* v : {&m.point, &m.x, &m.y}) turn(e.c, v->x, v->y);
}
HWY_INLINE void turn_all_back(const ErrorRotation& e, Pose& m) {
  for (Vector3* v : {&m.point, &m.x, &m.y}) turn_back(e.c, v->x, v->y);
  for (Vector3* v : {&m.point, &m.x, &m.y}) turn_back(e.b, v->z, v->x);
  for (Vector3* v : {&m.point, &m.x, &m.y}) turn_back(e.a, v->y, v->z);
}

HWY_INLINE void linear_axis(const TrunnionNumbers& n, int axis, Vector q, Pose& m) {
  const Vector s = hn::Mul(q, set(1.0 / 300));
  Vector e[6];
  for (int c = 0; c < 6; ++c) horner<1, 5>(n.legendre[axis][c], &s, &e[c]);
  turn_all(error_rotation({e[3], e[4], e[5]}), m);
  const double* u = n.direction[2 + axis];
  m.point = {hn::MulAdd(q, set(u[0]), hn::Add(m.point.x, e[0])), hn::MulAdd(q, set(u[1]), hn::Add(m.point.y, e[1])),
             hn::MulAdd(q, set(u[2]), hn::Add(m.point.z, e[2]))};
}

HWY_INLINE void inverted_rotary_axis(const TrunnionNumbers& n, int axis, Vector q, Pose& m) {
  const SineCosine one = sine_cosine(q);
  SineCosine harmonic[4] = {one, one, one, one};
  for (int h = 1; h < 4; ++h) {
    harmonic[h] = harmonic[h - 1];
    turn(one, harmonic[h].cosine, harmonic[h].sine);
  }
  Vector e[6];
  for (int c = 0; c < 6; ++c) {
    e[c] = set(n.fourier[axis][c][0]);
    for (int h = 0; h < 4; ++h) {
      e[c] = hn::MulAdd(set(n.fourier[axis][c][2 * h + 1]), harmonic[h].cosine, e[c]);
      e[c] = hn::MulAdd(set(n.fourier[axis][c][2 * h + 2]), harmonic[h].sine, e[c]);
    }
  }
  const Vector3 reference = set3(n.reference[axis]), centre = set3(n.centre[axis]);
  m.point = m.point - reference - Vector3{e[0], e[1], e[2]};
  turn_all_back(error_rotation({e[3], e[4], e[5]}), m);
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
  m.point = times(r, m.point) + centre;
  m.x = times(r, m.x);
  m.y = times(r, m.y);
}

void TransformTrunnion(const TrunnionNumbers& n, const double* const* commands, const double* const* start,
                       double* const* seen, std::size_t count) {
  const Tag d;
  for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
    const Vector zero = hn::Zero(d), one = set(1.0);
    Pose m{{hn::LoadU(d, start[0] + k), hn::LoadU(d, start[1] + k), hn::LoadU(d, start[2] + k)},
           {one, zero, zero},
           {zero, one, zero}};
    m.point = m.point + set3(n.tool_reference);
    linear_axis(n, 2, hn::LoadU(d, commands[4] + k), m);
    linear_axis(n, 1, hn::LoadU(d, commands[3] + k), m);
    linear_axis(n, 0, hn::LoadU(d, commands[2] + k), m);
    inverted_rotary_axis(n, 1, hn::LoadU(d, commands[1] + k), m);
    inverted_rotary_axis(n, 0, hn::LoadU(d, commands[0] + k), m);
    m.point = m.point - set3(n.workpiece);
    const Vector3 z = cross(m.x, m.y);
    const Vector out[12] = {m.point.x, m.point.y, m.point.z, m.x.x, m.y.x, z.x, m.x.y, m.y.y, z.y, m.x.z, m.y.z, z.z};
    for (int i = 0; i < 12; ++i) hn::StoreU(out[i], d, seen[i] + k);
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
      std::copy(a.begin(), a.end(), fourier[motion.axis][c]);
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
