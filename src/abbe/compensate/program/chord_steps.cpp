#include "abbe/compensate/program/chord_steps.h"

// Vectors are kept in structures here, which the sizeless vectors of SVE and RISC-V do not allow.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "abbe/compensate/program/chord_steps.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include "hwy/contrib/math/math-inl.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace abbe::chord {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, 8>;
using Vector = hn::Vec<Tag>;
using Lanes = CorrectionBlock::Lanes;

constexpr double kSpread = 1e-3;     // determinant against the squares above which an inverse keeps its digits
constexpr double kRoom = 2;          // within this part of the bounds of CorrectionStep nothing is bounded on the way
constexpr double kShortSine = 1e-3;  // below, the first two terms of its series give the angle to rounding
constexpr double kWellWithin = 0.1;  // of the tolerance
constexpr double kGain = 0.25;       // of what was missing: a step that leaves more does not serve

HWY_INLINE Vector set(double value) { return hn::Set(Tag(), value); }

struct Vector3 {
  Vector x, y, z;
};
HWY_INLINE Vector3 set3(const double* p) { return {set(p[0]), set(p[1]), set(p[2])}; }
HWY_INLINE Vector3 operator+(const Vector3& a, const Vector3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Vector3 operator-(const Vector3& a, const Vector3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vector dot(const Vector3& a, const Vector3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE Vector3 cross(const Vector3& a, const Vector3& b) {
  return {hn::NegMulAdd(a.z, b.y, hn::Mul(a.y, b.z)), hn::NegMulAdd(a.x, b.z, hn::Mul(a.z, b.x)),
          hn::NegMulAdd(a.y, b.x, hn::Mul(a.x, b.y))};
}
HWY_INLINE std::size_t whole_vectors(std::size_t count) {
  const std::size_t n = hn::Lanes(Tag());
  return (count + n - 1) / n * n;
}

HWY_INLINE Vector3 at(const Lanes* lanes, std::size_t k) {
  const Tag d;
  return {hn::LoadU(d, lanes[0].data() + k), hn::LoadU(d, lanes[1].data() + k), hn::LoadU(d, lanes[2].data() + k)};
}
HWY_INLINE void put(const Vector3& a, Lanes* lanes, std::size_t k) {
  const Tag d;
  hn::StoreU(a.x, d, lanes[0].data() + k);
  hn::StoreU(a.y, d, lanes[1].data() + k);
  hn::StoreU(a.z, d, lanes[2].data() + k);
}
HWY_INLINE void put_where(hn::Mask<Tag> mask, Vector v, double* out) {
  const Tag d;
  hn::StoreU(hn::IfThenElse(mask, v, hn::LoadU(d, out)), d, out);
}
HWY_INLINE Vector3 by(const Vector3& a, Vector factor) {
  return {hn::Mul(a.x, factor), hn::Mul(a.y, factor), hn::Mul(a.z, factor)};
}
HWY_INLINE Vector3 minus_scaled(const Vector3& a, const Vector3& b, Vector factor) {
  return {hn::NegMulAdd(b.x, factor, a.x), hn::NegMulAdd(b.y, factor, a.y), hn::NegMulAdd(b.z, factor, a.z)};
}

/// Of the carried body seen from the workpiece, in columns.
struct Frame {
  Vector3 x, y, z, origin;
};
HWY_INLINE Vector3 times_columns(const Frame& f, const double* v) {
  const Vector a = set(v[0]), b = set(v[1]), c = set(v[2]);
  return {hn::MulAdd(f.x.x, a, hn::MulAdd(f.y.x, b, hn::Mul(f.z.x, c))),
          hn::MulAdd(f.x.y, a, hn::MulAdd(f.y.y, b, hn::Mul(f.z.y, c))),
          hn::MulAdd(f.x.z, a, hn::MulAdd(f.y.z, b, hn::Mul(f.z.z, c)))};
}
/// The frame turned about a line of its own: its columns about the line's direction as the workpiece sees it.
HWY_INLINE void turn_frame(const Vector3& axis, const Vector3& centre, Vector angle, Frame& f) {
  const Vector sine = hn::Sin(Tag(), angle), cosine = hn::Cos(Tag(), angle);
  const Vector rest = hn::Sub(set(1.0), cosine);
  const auto turned = [&](const Vector3& v) HWY_ATTR {
    const Vector along = hn::Mul(dot(axis, v), rest);
    const Vector3 across = cross(axis, v);
    return Vector3{hn::MulAdd(axis.x, along, hn::MulAdd(across.x, sine, hn::Mul(v.x, cosine))),
                   hn::MulAdd(axis.y, along, hn::MulAdd(across.y, sine, hn::Mul(v.y, cosine))),
                   hn::MulAdd(axis.z, along, hn::MulAdd(across.z, sine, hn::Mul(v.z, cosine)))};
  };
  f.x = turned(f.x);
  f.y = turned(f.y);
  f.z = cross(f.x, f.y);
  f.origin = centre + turned(f.origin - centre);
}

/// Rotations of the turning axes and ways of the reaching ones per unit, as the workpiece sees them.
struct Twists {
  Vector3 turn[2], lever[2], reach[3];
};

HWY_INLINE Twists twists_at(const ChordSteps::Numbers& n, const CorrectionBlock& block, const Vector3& point,
                            std::size_t k) {
  const Tag d;
  Twists t;
  const double* r = n.rotation;
  Frame f{{set(r[0]), set(r[3]), set(r[6])},
          {set(r[1]), set(r[4]), set(r[7])},
          {set(r[2]), set(r[5]), set(r[8])},
          set3(n.offset)};
  for (const ChordSteps::Line& line : n.lines) {
    const Vector way = hn::Mul(hn::LoadU(d, block.position[line.axis].data() + k), set(line.sign));
    const Vector3 axis = times_columns(f, line.direction);
    if (!line.rotary) {
      f.origin = minus_scaled(f.origin, axis, hn::Neg(way));
      if (line.reaching >= 0) t.reach[line.reaching] = by(axis, set(line.sign));
      continue;
    }
    const Vector3 centre = times_columns(f, line.point) + f.origin;
    if (line.turning >= 0) {
      t.turn[line.turning] = by(axis, set(line.sign));
      t.lever[line.turning] = cross(t.turn[line.turning], point - centre);
    }
    turn_frame(axis, centre, way, f);
  }
  return t;
}

/// What is missing at one vector of poses.
struct Missing {
  Vector3 point, turn;    ///< mm; rotation vector, rad
  Vector shift, angle;    ///< their lengths
  hn::Mask<Tag> is_near;  ///< the angle is small enough for its series
};
HWY_INLINE Missing missing_at(const ChordSteps::Numbers& n, const CorrectionBlock& block, std::size_t k) {
  Missing m;
  m.point = at(block.goal_point.data(), k) - at(block.point.data(), k);
  m.shift = hn::Sqrt(dot(m.point, m.point));
  const Vector3 goal = at(block.goal_direction.data(), k), direction = at(block.direction.data(), k);
  const Vector3 axis = cross(direction, goal);
  const Vector square = dot(axis, axis);
  m.is_near = hn::And(hn::Lt(square, set(kShortSine * kShortSine)), hn::Gt(dot(direction, goal), set(0.0)));
  m.turn = by(axis, hn::MulAdd(square, set(1.0 / 6), set(1.0)));
  m.angle = n.oriented ? hn::Sqrt(dot(m.turn, m.turn)) : set(0.0);
  return m;
}

void StartChord(const ChordSteps::Numbers& n, const CorrectionBlock& block, ChordBlock& chord) {
  const Tag d;
  for (std::size_t k = 0; k < whole_vectors(block.count); k += hn::Lanes(d)) {
    const Vector3 point = at(block.point.data(), k), direction = at(block.direction.data(), k);
    const Twists t = twists_at(n, block, point, k);
    const Missing m = missing_at(n, block, k);
    Vector3 rest = m.point;
    auto serves = hn::Gt(hn::LoadU(d, chord.left.data() + k), set(0.0));
    if (n.turns) {
      const Vector3 a0 = cross(t.turn[0], direction), a1 = cross(t.turn[1], direction);
      const Vector turns = dot(cross(a0, a1), direction), square = hn::Add(dot(a0, a0), dot(a1, a1));
      const Vector inverse = hn::Div(set(1.0), turns), size = hn::Abs(turns);
      // A value that the smallest singular value is surely not below, as in CorrectionStep::take_derivative().
      const auto spread = hn::Gt(size, hn::Mul(set(kSpread), square));
      const auto short_turn = hn::Gt(hn::Mul(size, set(n.largest_turn / kRoom)), hn::Mul(m.angle, hn::Sqrt(square)));
      serves = hn::And(hn::And(serves, m.is_near), hn::And(spread, short_turn));
      const Vector3 h0 = by(a1, inverse), h1 = by(a0, hn::Neg(inverse));
      put(h0, chord.turn[0], k);
      put(h1, chord.turn[1], k);
      put(t.lever[0], chord.lever[0], k);
      put(t.lever[1], chord.lever[1], k);
      rest = minus_scaled(rest, t.lever[0], dot(h0, m.turn));
      rest = minus_scaled(rest, t.lever[1], dot(h1, m.turn));
    }
    const Vector3 c0 = cross(t.reach[1], t.reach[2]);
    const Vector determinant = dot(t.reach[0], c0), inverse = hn::Div(set(1.0), determinant);
    put(by(c0, inverse), chord.reach[0], k);
    put(by(cross(t.reach[2], t.reach[0]), inverse), chord.reach[1], k);
    put(by(cross(t.reach[0], t.reach[1]), inverse), chord.reach[2], k);
    // The directions are unit vectors: half the sum of their squares is 3 / 2.
    const auto spread = hn::Gt(hn::Abs(determinant), set(kSpread * 1.8371173070873836));
    const auto short_way = hn::Gt(hn::Mul(hn::Abs(determinant), set(n.largest_shift / 1.5)),
                                  hn::Mul(hn::Sqrt(dot(rest, rest)), set(2 * kRoom)));
    serves = hn::And(serves, hn::And(spread, short_way));
    const Vector left = hn::LoadU(d, chord.left.data() + k);
    hn::StoreU(hn::IfThenElse(hn::Or(serves, hn::Eq(left, set(0.0))), left, set(-1.0)), d, chord.left.data() + k);
    hn::StoreU(set(1e300), d, chord.missing.data() + k);
  }
}

bool StepAlongChord(const ChordSteps::Numbers& n, CorrectionBlock& block, ChordBlock& chord) {
  const Tag d;
  auto any = hn::Lt(set(0.0), set(0.0));
  for (std::size_t k = 0; k < whole_vectors(block.count); k += hn::Lanes(d)) {
    const Vector before = hn::LoadU(d, chord.left.data() + k);
    const auto open = hn::Gt(before, set(0.0));
    if (hn::AllFalse(d, open)) continue;
    const Missing m = missing_at(n, block, k);
    put_where(open, m.shift, block.position_residual.data() + k);
    put_where(open, m.angle, block.orientation_residual.data() + k);
    const Vector angle = hn::Mul(m.angle, set(n.turns ? 1 / n.orientation_tolerance : 0.0));
    const Vector missing = hn::Max(hn::Mul(m.shift, set(1 / n.position_tolerance)), angle);
    auto serves = hn::Le(missing, hn::Mul(set(kGain), hn::LoadU(d, chord.missing.data() + k)));
    if (n.oriented) serves = hn::And(serves, m.is_near);
    // Within the tolerance a step is taken only where it gains much.
    const auto reached = hn::Or(hn::Le(missing, set(kWellWithin)), hn::AndNot(serves, hn::Le(missing, set(1.0))));
    hn::StoreU(missing, d, chord.missing.data() + k);
    Vector left = hn::IfThenElse(serves, before, set(-1.0));
    left = hn::IfThenElse(reached, set(0.0), left);
    left = hn::IfThenElse(open, left, before);
    hn::StoreU(left, d, chord.left.data() + k);
    const auto goes_on = hn::Gt(left, set(0.0));
    any = hn::Or(any, goes_on);
    Vector3 rest = m.point;
    for (const ChordSteps::Line& line : n.lines) {
      if (line.turning < 0) continue;
      const Vector turn = dot(at(chord.turn[line.turning], k), m.turn);
      rest = minus_scaled(rest, at(chord.lever[line.turning], k), turn);
      double* position = block.position[line.axis].data() + k;
      put_where(goes_on, hn::Add(hn::LoadU(d, position), turn), position);
    }
    for (const ChordSteps::Line& line : n.lines) {
      if (line.reaching < 0) continue;
      const Vector shift = dot(at(chord.reach[line.reaching], k), rest);
      double* position = block.position[line.axis].data() + k;
      put_where(goes_on, hn::Add(hn::LoadU(d, position), shift), position);
    }
  }
  return !hn::AllFalse(d, any);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace abbe::chord
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe {
namespace chord {

HWY_EXPORT(StartChord);
HWY_EXPORT(StepAlongChord);

namespace {

// In the namespace of the kernels: where all is compiled for one processor, Highway accepts no name with a namespace.
void start_chord(const ChordSteps::Numbers& n, const CorrectionBlock& block, ChordBlock& chord) {
  HWY_DYNAMIC_DISPATCH(StartChord)(n, block, chord);
}
bool step_along_chord(const ChordSteps::Numbers& n, CorrectionBlock& block, ChordBlock& chord) {
  return HWY_DYNAMIC_DISPATCH(StepAlongChord)(n, block, chord);
}

}  // namespace
}  // namespace chord

ChordSteps::ChordSteps(const Machine& machine, const CorrectionOptions& options,
                       const std::vector<std::size_t>& turning, const std::vector<std::size_t>& reaching) {
  const auto place = [](const std::vector<std::size_t>& axes, std::size_t axis) {
    for (std::size_t i = 0; i < axes.size(); ++i) {
      if (axes[i] == axis) return static_cast<int>(i);
    }
    return -1;
  };
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    Line line{i, axis.kind == AxisKind::rotary, place(turning, i), place(reaching, i)};
    line.sign = axis.side == ChainSide::workpiece ? -axis.sense() : axis.sense();
    for (int k = 0; k < 3; ++k) line.direction[k] = axis.direction[k];
    for (int k = 0; k < 3; ++k) line.point[k] = axis.point[k];
    numbers_.lines.push_back(line);
  }
  const RigidTransform workpiece_from_bed = machine.bed_from_workpiece.inverse();
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) numbers_.rotation[3 * i + k] = workpiece_from_bed.rotation(i, k);
    numbers_.offset[i] = workpiece_from_bed.translation[i];
  }
  numbers_.turns = !turning.empty();
  numbers_.oriented = options.target != TargetKind::point;
  numbers_.largest_turn = options.largest_turn;
  numbers_.largest_shift = options.largest_shift;
  numbers_.position_tolerance = options.position_tolerance;
  numbers_.orientation_tolerance = options.orientation_tolerance;
}

void ChordSteps::start(const CorrectionBlock& block, ChordBlock& chord) const {
  for (std::size_t k = 0; k < kCorrectionBlock; ++k) {
    chord.left[k] = k < block.count && block.active[k] != 0 ? 1 : 0;
  }
  chord::start_chord(numbers_, block, chord);
}

bool ChordSteps::step(CorrectionBlock& block, ChordBlock& chord) const {
  return chord::step_along_chord(numbers_, block, chord);
}

}  // namespace abbe
#endif
