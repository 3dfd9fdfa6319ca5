// Closed forms for six axes of which three neighbours meet in a point (Pieper 1968) or are parallel.
//
// In both, two of the three other angles are found from the same two equations. With a vector w(t) that turns with the
// one angle t, and g the part across an axis of w after a turn about that axis,
//
//   V g = b(t),   |g|^2 = |w across the axis|^2 =: r(t)
//
// where V is a constant 2 x 2 matrix and b has constants and the first harmonic of t only. If V can be inverted, this
// is a polynomial of degree four in tan t/2. If it cannot, which is the rule in built arms (two axes parallel or
// meeting), a combination of the two equations has no g: it gives t, and the other one gives g twice.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "abbe/geometry/angle.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/orientation.h"
#include "abbe/machine/six_axis_loop.h"

namespace abbe {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// a + c cos t + s sin t
struct FirstHarmonic {
  double a = 0, c = 0, s = 0;
  double at(double t) const { return a + c * std::cos(t) + s * std::sin(t); }
  double amplitude() const { return std::hypot(c, s); }
  friend FirstHarmonic operator+(const FirstHarmonic& x, const FirstHarmonic& y) {
    return {x.a + y.a, x.c + y.c, x.s + y.s};
  }
  friend FirstHarmonic operator*(double f, const FirstHarmonic& x) { return {f * x.a, f * x.c, f * x.s}; }
};

/// Vector turned about a unit axis by t.
struct TurnedVector {
  Vector3d a, c, s;
  TurnedVector(const Vector3d& axis, const Vector3d& v)
      : a(axis * axis.dot(v)), c(v - axis * axis.dot(v)), s(axis.cross(v)) {}
  FirstHarmonic along(const Vector3d& d) const { return {d.dot(a), d.dot(c), d.dot(s)}; }
  Vector3d at(double t) const { return a + std::cos(t) * c + std::sin(t) * s; }
};

struct TurnAndVector {
  double t = 0;
  Vector2d g = Vector2d::Zero();
  bool t_is_free = false;
};

struct TurnList {
  std::array<TurnAndVector, 16> item;
  std::size_t count = 0;
  void add(const TurnAndVector& one) {
    if (count < item.size()) item[count++] = one;
  }
};

/// Real parts of the nearly real roots of p[0] + p[1] x + ... + p[4] x^4, p[4] not small (Aberth's simultaneous
/// iteration).
std::size_t nearly_real_roots(const std::array<double, 5>& p, std::array<double, 4>& real) {
  using Complex = std::complex<double>;
  std::array<Complex, 4> root;
  double radius = 0;
  for (int i = 0; i < 4; ++i) radius = std::max(radius, std::pow(std::abs(p[i] / p[4]), 1.0 / (4 - i)));
  for (int i = 0; i < 4; ++i) root[i] = std::polar(std::max(radius, 1e-3), 0.4 + 0.5 * std::numbers::pi * i);
  for (int iteration = 0; iteration < 60; ++iteration) {
    double change = 0;
    for (int i = 0; i < 4; ++i) {
      Complex value = p[4], slope = 0;
      for (int k = 3; k >= 0; --k) {
        slope = slope * root[i] + value;
        value = value * root[i] + p[k];
      }
      if (value == Complex(0)) continue;
      Complex others = 0;
      for (int k = 0; k < 4; ++k) {
        if (k != i && root[k] != root[i]) others += 1.0 / (root[i] - root[k]);
      }
      const Complex step = 1.0 / (slope / value - others);
      if (!std::isfinite(step.real()) || !std::isfinite(step.imag())) continue;
      root[i] -= step;
      change = std::max(change, std::abs(step) / (1 + std::abs(root[i])));
    }
    if (change < 1e-15) break;
  }
  constexpr double kNearlyReal = 1e-3;  // double roots come as pairs beside the real axis; Newton's method decides
  std::size_t count = 0;
  for (const Complex& x : root) {
    if (std::abs(x.imag()) <= kNearlyReal * (1 + std::norm(x))) real[count++] = x.real();
  }
  return count;
}

/// Angles where a trigonometric polynomial of degree two vanishes, nearly at least.
/// @param f  its values at 0, 72, 144, 216 and 288 degrees
std::size_t roots_of_second_harmonic(const std::array<double, 5>& f, std::array<double, 4>& roots) {
  constexpr double kFifth = 2 * std::numbers::pi / 5;
  double a0 = 0, a[2] = {0, 0}, b[2] = {0, 0};
  for (int i = 0; i < 5; ++i) {
    a0 += f[i] / 5;
    for (int k = 0; k < 2; ++k) {
      a[k] += 0.4 * f[i] * std::cos(kFifth * i * (k + 1));
      b[k] += 0.4 * f[i] * std::sin(kFifth * i * (k + 1));
    }
  }
  // Half a turn from the zero of the angle tan t/2 is infinite: that goes where the polynomial is largest.
  double zero = 0, largest = -1;
  for (int i = 0; i < 12; ++i) {
    const double t = std::numbers::pi / 6 * i;
    const double value =
        std::abs(a0 + a[0] * std::cos(t) + b[0] * std::sin(t) + a[1] * std::cos(2 * t) + b[1] * std::sin(2 * t));
    if (value > largest) {
      largest = value;
      zero = t + std::numbers::pi;
    }
  }
  if (!(largest > 0)) return 0;
  const double c1 = a[0] * std::cos(zero) + b[0] * std::sin(zero), s1 = b[0] * std::cos(zero) - a[0] * std::sin(zero);
  const double c2 = a[1] * std::cos(2 * zero) + b[1] * std::sin(2 * zero),
               s2 = b[1] * std::cos(2 * zero) - a[1] * std::sin(2 * zero);
  // cos t = (1-x^2)/(1+x^2), sin t = 2x/(1+x^2), cos 2t = (1-6x^2+x^4)/(1+x^2)^2, sin 2t = 4x(1-x^2)/(1+x^2)^2
  const std::array<double, 5> p{a0 + c1 + c2, 2 * s1 + 4 * s2, 2 * a0 - 6 * c2, 2 * s1 - 4 * s2, a0 - c1 + c2};
  std::array<double, 4> x{};
  const std::size_t count = nearly_real_roots(p, x);
  for (std::size_t i = 0; i < count; ++i) roots[i] = zero + 2 * std::atan(x[i]);
  return count;
}

/// The two equations of the head of this file.
///
/// @param v      rows: vectors across the axis
/// @param b      right sides
/// @param along  w along the axis; square: |w|^2. So r = square - along^2
/// @param start  angle t where it is free
TurnList solve_two_equations(const Matrix2d& v, const std::array<FirstHarmonic, 2>& b, const FirstHarmonic& along,
                             const FirstHarmonic& square, double start) {
  constexpr double kDependent = 1e-4;  // below, the way for V without inverse is tried; above 1e-9, the other one too
  constexpr double kAlways = 1e-9;
  const auto r = [&](double t) { return square.at(t) - along.at(t) * along.at(t); };
  // Singular values and vectors of the rows: U' V = diag(s) W'.
  const Matrix2d gram = v * v.transpose();
  const double angle = 0.5 * std::atan2(2 * gram(0, 1), gram(0, 0) - gram(1, 1));
  const double cosine = std::cos(angle), sine = std::sin(angle);
  const Vector2d first = cosine * v.row(0) + sine * v.row(1), second = cosine * v.row(1) - sine * v.row(0);
  const double large = first.norm(), small = second.norm();
  const FirstHarmonic b_first = cosine * b[0] + sine * b[1], b_second = cosine * b[1] + (-sine) * b[0];
  TurnList list;
  if (!(large > kAlways)) return list;
  const Vector2d unit = first / large, across(-unit[1], unit[0]);
  if (small > kAlways * large) {
    std::array<double, 5> f{};
    for (int i = 0; i < 5; ++i) {
      const double t = 2 * std::numbers::pi / 5 * i;
      const double g1 = b_first.at(t) * (small / large), g2 = b_second.at(t);
      f[static_cast<std::size_t>(i)] = g1 * g1 + g2 * g2 - small * small * r(t);
    }
    std::array<double, 4> roots{};
    const std::size_t count = roots_of_second_harmonic(f, roots);
    for (std::size_t i = 0; i < count; ++i) {
      list.add({roots[i], unit * (b_first.at(roots[i]) / large) + second * (b_second.at(roots[i]) / (small * small)),
                false});
    }
    if (small > kDependent * large) return list;
  }
  std::array<double, 2> turns{start, start};
  std::size_t count = 1;
  bool free = true;
  const double amplitude = b_second.amplitude();
  if (amplitude > kAlways * large) {
    const double phase = std::atan2(b_second.s, b_second.c), ratio = -b_second.a / amplitude;
    free = false;
    if (std::abs(ratio) > 1 + 1e-2) return list;
    const double half = std::acos(std::clamp(ratio, -1.0, 1.0));
    turns = {phase + half, phase - half};
    count = half < 1e-9 || half > std::numbers::pi - 1e-9 ? 1 : 2;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double t = turns[i], g1 = b_first.at(t) / large, rest = r(t) - g1 * g1;
    if (rest < -0.05 * std::max(r(t), g1 * g1)) continue;
    const double g2 = std::sqrt(std::max(rest, 0.0));
    list.add({t, g1 * unit + g2 * across, free});
    if (g2 > 0) list.add({t, g1 * unit - g2 * across, free});
  }
  return list;
}

/// Plane across an axis.
struct AcrossPlane {
  Vector3d first, second;
  explicit AcrossPlane(const Vector3d& axis) : first(axis.unitOrthogonal()), second(axis.cross(first)) {}
  Vector2d part(const Vector3d& v) const { return {first.dot(v), second.dot(v)}; }
  Vector3d whole(const Vector2d& g) const { return g[0] * first + g[1] * second; }
};

constexpr double kOnAxis = 1e-10;  // of the loop's size: a point there is not moved by the axis

/// Angle about an axis that turns `from` to `to`, or the start where it turns nothing.
double turn_or_start(const Vector3d& axis, const Vector3d& from, const Vector3d& to, double start, bool& free) {
  free = axis.cross(from).norm() < kOnAxis || axis.cross(to).norm() < kOnAxis;
  return free ? start : angle_about(axis, from, to);
}

/// Axes 3, 4 and 5 meet in `centre`. Lengths in units of the loop's size.
void meeting_axes(const SixAxisLoop& loop, const Vector3d& centre, const LoopAngles& start,
                  LoopCandidates& candidates) {
  const Vector3d goal = loop.target * centre;
  const Vector3d &u0 = loop.direction[0], &u1 = loop.direction[1], &u2 = loop.direction[2];
  const Vector3d &o0 = loop.point[0], &o1 = loop.point[1], &o2 = loop.point[2];
  // E1 E2 centre has the same height and distance as the goal, seen from axis 0.
  const TurnedVector turned(u2, centre - o2);
  const Vector3d m = o1 - o0, n = o2 - o1;
  const FirstHarmonic along = FirstHarmonic{u1.dot(n)} + turned.along(u1);
  const FirstHarmonic square = FirstHarmonic{n.squaredNorm() + (centre - o2).squaredNorm()} + 2 * turned.along(n);
  const AcrossPlane plane(u1);
  Matrix2d v;
  v.row(0) = plane.part(u0);
  v.row(1) = plane.part(m);
  const std::array<FirstHarmonic, 2> b{
      FirstHarmonic{u0.dot(goal - o1)} + (-u0.dot(u1)) * along,
      FirstHarmonic{0.5 * ((goal - o0).squaredNorm() - m.squaredNorm())} + (-0.5) * square + (-m.dot(u1)) * along};
  const TurnList list = solve_two_equations(v, b, along, square, start[2]);
  for (std::size_t k = 0; k < list.count; ++k) {
    LoopCandidate candidate;
    if (list.item[k].t_is_free) candidate.free_axis = 2;
    candidate.angle = start;
    candidate.angle[2] = list.item[k].t;
    bool free = false;
    const Vector3d w = n + turned.at(list.item[k].t);
    candidate.angle[1] = turn_or_start(u1, w, plane.whole(list.item[k].g), start[1], free);
    if (free) candidate.free_axis = 1;
    const Vector3d reached = loop.turn(1, candidate.angle[1]) * Vector3d(o1 + w);
    candidate.angle[0] = turn_or_start(u0, reached - o0, goal - o0, start[0], free);
    if (free) candidate.free_axis = 0;
    const Eigen::Matrix3d rest = loop.turns(0, 3, candidate.angle).rotation.transpose() * loop.target.rotation;
    const RotaryBranches wrist = turn_frame({&loop.direction[3], 3}, rest, start[3]);
    for (int j = 0; j < wrist.count; ++j) {
      const RotaryAngles& found = wrist.branch[static_cast<std::size_t>(j)];
      std::copy(found.angle.begin(), found.angle.end(), candidate.angle.begin() + 3);
      if (found.singularity == RotarySingularity::first_axis_free) candidate.free_axis = 3;
      candidates.add(candidate);
    }
  }
}

/// Axes 0, 1 and 2 are parallel. Lengths in units of the loop's size.
void parallel_axes(const SixAxisLoop& loop, const Vector3d& u, const LoopAngles& start, LoopCandidates& candidates) {
  const Vector3d &u3 = loop.direction[3], &u4 = loop.direction[4], &u5 = loop.direction[5];
  const Vector3d &o3 = loop.point[3], &o4 = loop.point[4], &o5 = loop.point[5];
  // The parallel axes keep their direction and heights along it; with v and w the direction and a point seen from the
  // target, E3 E4 E5 must turn v to u and bring w to its height.
  const RigidTransform back = loop.target.inverse();
  const Vector3d v = back.rotation * u, x = loop.point[0], w = back * x;
  const TurnedVector y(u5, v);
  const Vector3d m = o4 - o3;
  const FirstHarmonic along = y.along(u4);
  const AcrossPlane plane(u4);
  Matrix2d rows;
  rows.row(0) = plane.part(u3);
  rows.row(1) = plane.part(m);
  const std::array<FirstHarmonic, 2> b{
      FirstHarmonic{u3.dot(u)} + (-u3.dot(u4)) * along,
      FirstHarmonic{u.dot(x - o3) - v.dot(w - o5)} + (-1) * y.along(o5 - o4) + (-m.dot(u4)) * along};
  const TurnList list = solve_two_equations(rows, b, along, FirstHarmonic{1}, start[5]);
  for (std::size_t k = 0; k < list.count; ++k) {
    LoopCandidate candidate;
    if (list.item[k].t_is_free) candidate.free_axis = 5;
    candidate.angle = start;
    candidate.angle[5] = list.item[k].t;
    bool free = false;
    const Vector3d turned = y.at(list.item[k].t);
    candidate.angle[4] = turn_or_start(u4, turned, plane.whole(list.item[k].g), start[4], free);
    if (free) candidate.free_axis = 4;
    candidate.angle[3] = turn_or_start(u3, rotation_about(u4, candidate.angle[4]) * turned, u, start[3], free);
    if (free) candidate.free_axis = 3;
    const RigidTransform planar = loop.target * loop.turns(3, 3, candidate.angle).inverse();
    const Vector3d goal = planar * loop.point[2], &o0 = loop.point[0], &o1 = loop.point[1];
    const auto across = [&](const Vector3d& d) { return Vector3d(d - u * u.dot(d)); };
    const Vector3d first = across(o1 - o0), second = across(loop.point[2] - o1), wanted = across(goal - o0);
    // Sides of a triangle: |first + turned second| = |wanted|.
    const double product = first.norm() * second.norm();
    if (!(product > kOnAxis)) continue;
    const double ratio = (wanted.squaredNorm() - first.squaredNorm() - second.squaredNorm()) / (2 * product);
    if (std::abs(ratio) > 1 + 1e-2) continue;
    const double half = std::acos(std::clamp(ratio, -1.0, 1.0)), zero = angle_about(u, second, first);
    for (const double sign : {1.0, -1.0}) {
      candidate.angle[1] = zero + sign * half;
      const Vector3d reached = first + rotation_about(u, candidate.angle[1]) * second;
      candidate.angle[0] = turn_or_start(u, reached, wanted, start[0], free);
      if (free) candidate.free_axis = 0;
      const Eigen::Matrix3d rest = rotation_about(u, -candidate.angle[0] - candidate.angle[1]) * planar.rotation;
      const Vector3d arm = u.unitOrthogonal();
      candidate.angle[2] = angle_about(u, arm, rest * arm);
      candidates.add(candidate);
      if (half < 1e-9) break;
    }
  }
}

/// Point nearest to three lines, and the largest distance of a line from it.
double departure_from_meeting(const SixAxisLoop& loop, std::size_t first, Vector3d& centre) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (std::size_t i = first; i < first + 3; ++i) {
    const Vector3d& u = loop.direction[i];
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - u * u.transpose();
    sum += across;
    right += across * (loop.point[i] - loop.point[first]);
  }
  if (!(std::abs(sum.determinant()) > 1e-6)) return std::numeric_limits<double>::infinity();
  centre = loop.point[first] + sum.inverse() * right;
  double largest = 0;
  for (std::size_t i = first; i < first + 3; ++i) {
    largest = std::max(largest, loop.direction[i].cross(centre - loop.point[i]).norm());
  }
  // Neighbours that are parallel turn no frame.
  for (std::size_t i = first; i < first + 2; ++i) {
    if (loop.direction[i].cross(loop.direction[i + 1]).norm() < 1e-3) return std::numeric_limits<double>::infinity();
  }
  return largest;
}

double departure_from_parallel(const SixAxisLoop& loop, std::size_t first, Vector3d& direction) {
  direction = loop.direction[first];
  for (std::size_t i = first + 1; i < first + 3; ++i) {
    direction += direction.dot(loop.direction[i]) > 0 ? loop.direction[i] : Vector3d(-loop.direction[i]);
  }
  direction.normalize();
  double largest = 0;
  for (std::size_t i = first; i < first + 3; ++i) {
    largest = std::max(largest, direction.cross(loop.direction[i]).norm());
  }
  return largest;
}

/// Which three neighbouring axes are nearest to meeting or to being parallel. Lengths in units of the loop's size.
struct ThreeAxes {
  double departure = std::numeric_limits<double>::infinity();
  std::size_t first = 0;
  bool meet = false;
  Vector3d centre_or_direction = Vector3d::Zero();
};

ThreeAxes three_axes(const SixAxisLoop& loop) {
  constexpr double kClearlyLess = 0.5;
  ThreeAxes best;
  for (const bool meet : {true, false}) {
    for (std::size_t first = kLoopAxes - 2; first-- > 0;) {
      Vector3d found = Vector3d::Zero();
      const double away =
          meet ? departure_from_meeting(loop, first, found) : departure_from_parallel(loop, first, found);
      const bool rounding = best.departure < 1e-12;
      if (!rounding && away < kClearlyLess * best.departure) best = {away, first, meet, found};
    }
  }
  return best;
}

SixAxisLoop in_its_own_size(const SixAxisLoop& given) {
  SixAxisLoop loop = given;
  const double size = given.size();
  for (Vector3d& point : loop.point) point /= size;
  loop.target.translation /= size;
  return loop;
}

}  // namespace

double departure_from_decoupled(const SixAxisLoop& loop) { return three_axes(in_its_own_size(loop)).departure; }

void add_decoupled_candidates(const SixAxisLoop& given, const LoopAngles& start, LoopCandidates& candidates) {
  const SixAxisLoop loop = in_its_own_size(given);
  const ThreeAxes three = three_axes(loop);
  if (!std::isfinite(three.departure)) return;
  // The loop begun so that axes that meet are its last ones, and parallel ones its first.
  const std::size_t begin = three.meet ? (three.first + 3) % kLoopAxes : three.first;
  SixAxisLoop begun = loop.begun_at(begin);
  LoopAngles begun_start{};
  for (std::size_t i = 0; i < kLoopAxes; ++i) begun_start[i] = start[(i + begin) % kLoopAxes];
  LoopAngles sign{1, 1, 1, 1, 1, 1};
  LoopCandidates found;
  if (three.meet) {
    const bool passed = three.first < begin;
    const Vector3d& centre = three.centre_or_direction;
    meeting_axes(begun, passed ? loop.target.inverse() * centre : centre, begun_start, found);
  } else {
    for (std::size_t i = 0; i < 3; ++i) {
      if (begun.direction[i].dot(three.centre_or_direction) > 0) continue;
      sign[i] = -1;  // an axis that points the other way turns with the other sign
      begun_start[i] = -begun_start[i];
      begun.direction[i] = -begun.direction[i];
    }
    parallel_axes(begun, three.centre_or_direction, begun_start, found);
  }
  for (std::size_t k = 0; k < found.size(); ++k) {
    LoopCandidate candidate = found[k];
    for (std::size_t i = 0; i < kLoopAxes; ++i) candidate.angle[i] *= sign[i];
    candidate.angle = SixAxisLoop::in_first_order(candidate.angle, begin);
    if (candidate.free_axis < kLoopAxes) candidate.free_axis = (candidate.free_axis + begin) % kLoopAxes;
    candidates.add(candidate);
  }
}

}  // namespace abbe
