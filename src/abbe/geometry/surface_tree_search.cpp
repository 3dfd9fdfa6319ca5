// Vectors are kept in structures here, which the sizeless vectors of SVE and RISC-V do not allow (as in errors/).
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)

#include <algorithm>
#include <cmath>

#include "abbe/geometry/surface_tree.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "abbe/geometry/surface_tree_search.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace abbe::surface {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, kWidth>;
using Floats = hn::CappedTag<float, kWidth>;
using Vector = hn::Vec<Doubles>;

struct Vector3 {
  Vector x, y, z;
};
HWY_INLINE Vector3 load(const std::array<Leaf::Row, 3>& rows, std::size_t lane) {
  const Doubles d;
  return {hn::Load(d, rows[0].data() + lane), hn::Load(d, rows[1].data() + lane), hn::Load(d, rows[2].data() + lane)};
}
HWY_INLINE Vector3 minus(const Vector3& a, const Vector3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vector dot(const Vector3& a, const Vector3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE Vector3 cross(const Vector3& a, const Vector3& b) {
  return {hn::NegMulAdd(a.z, b.y, hn::Mul(a.y, b.z)), hn::NegMulAdd(a.x, b.z, hn::Mul(a.z, b.x)),
          hn::NegMulAdd(a.y, b.x, hn::Mul(a.x, b.y))};
}

/// From the nearest point of an edge to a point that is given from the beginning of the edge.
HWY_INLINE Vector3 from_edge(const Vector3& from_start, const Vector3& edge, Vector inverse_square) {
  const Doubles d;
  const Vector along = hn::Mul(dot(from_start, edge), inverse_square);
  const Vector t = hn::Min(hn::Max(along, hn::Zero(d)), hn::Set(d, 1.0));
  return {hn::NegMulAdd(t, edge.x, from_start.x), hn::NegMulAdd(t, edge.y, from_start.y),
          hn::NegMulAdd(t, edge.z, from_start.z)};
}
template <class Mask>
HWY_INLINE Vector3 choose(Mask mask, const Vector3& yes, const Vector3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}

/// Squared distances of a point to the triangles of a leaf from `lane` on, as many as a vector holds.
///
/// The distance to the plane where the point lies over the triangle, else that to the nearest edge. The first is
/// measured from the nearest edge: the normal of a needle is least sure in the direction of its length, in which
/// nothing is left from there.
HWY_INLINE Vector triangle_squares(const Leaf& leaf, std::size_t lane, const double* point) {
  const Doubles d;
  const Vector3 p = {hn::Set(d, point[0]), hn::Set(d, point[1]), hn::Set(d, point[2])};
  const Vector3 ap = minus(p, load(leaf.corner, lane)), ab = load(leaf.edge_ab, lane), ac = load(leaf.edge_ac, lane),
                normal = load(leaf.normal, lane);
  const Vector3 bp = minus(ap, ab), bc = minus(ac, ab);
  const Vector zero = hn::Zero(d);
  Vector3 nearest = from_edge(ap, ab, hn::Load(d, leaf.inverse_square[0].data() + lane));
  Vector square = dot(nearest, nearest);
  const auto take = [&](const Vector3& rest) HWY_ATTR {
    const Vector its_square = dot(rest, rest);
    nearest = choose(hn::Lt(its_square, square), rest, nearest);
    square = hn::Min(square, its_square);
  };
  take(from_edge(ap, ac, hn::Load(d, leaf.inverse_square[1].data() + lane)));
  take(from_edge(bp, bc, hn::Load(d, leaf.inverse_square[2].data() + lane)));
  const Vector over_ab = dot(normal, cross(ab, ap)), over_ac = dot(normal, cross(ap, ac)),
               over_bc = dot(normal, cross(bc, bp));
  const auto inside =
      hn::And(hn::Ge(hn::Min(hn::Min(over_ab, over_ac), over_bc), zero), hn::Gt(dot(normal, normal), hn::Set(d, 0.5)));
  const Vector height = dot(normal, nearest);
  return hn::IfThenElse(inside, hn::Min(hn::Mul(height, height), square), square);
}

void visit_leaf(const Tree& tree, std::uint32_t number, const double* point, Found* best) {
  const Doubles d;
  const Leaf& leaf = tree.leaves[number];
  HWY_ALIGN double squares[kWidth];
  for (std::size_t lane = 0; lane < kWidth; lane += hn::Lanes(d)) {
    hn::Store(triangle_squares(leaf, lane, point), d, squares + lane);
  }
  for (std::uint32_t lane = 0; lane < kWidth; ++lane) {
    if (squares[lane] < best->square || (squares[lane] == best->square && leaf.index[lane] < best->triangle)) {
      *best = {{number, lane}, leaf.index[lane], squares[lane]};
    }
  }
}

/// Largest single-precision bound that may still hold something as near as `square`: the rounding of the search in
/// single precision is below 2^-20 of it.
HWY_INLINE float bound_of(double square) { return static_cast<float>(std::min(square * 1.000002, 3e38)); }

struct Waiting {
  std::uint32_t child;
  float bound;
};

void search_point(const Tree& tree, const double* point, double start, Found* best) {
  const Floats f;
  // Farther coordinates would overflow; nearer ones are only more cautious.
  float single[3];
  for (int k = 0; k < 3; ++k) single[k] = static_cast<float>(std::min(std::max(point[k], -1e18), 1e18));
  const auto px = hn::Set(f, single[0]), py = hn::Set(f, single[1]), pz = hn::Set(f, single[2]);
  const auto zero = hn::Zero(f);
  float limit = bound_of(start);
  Waiting stack[8 * 64];  // at most seven more per level, of which there are fewer than 64
  std::size_t waiting = 1;
  stack[0] = {0, 0};
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    if (next.bound > limit) continue;
    if ((next.child & kLeaf) != 0) {
      visit_leaf(tree, next.child & ~kLeaf, point, best);
      limit = std::min(limit, bound_of(best->square));
      continue;
    }
    const Node& node = tree.nodes[next.child];
    HWY_ALIGN float bounds[kWidth];
    for (std::size_t i = 0; i < kWidth; i += hn::Lanes(f)) {
      const auto outside = [&](std::size_t axis, hn::Vec<Floats> p) HWY_ATTR {
        return hn::Max(hn::Max(hn::Sub(hn::Load(f, node.low[axis].data() + i), p),
                               hn::Sub(p, hn::Load(f, node.high[axis].data() + i))),
                       zero);
      };
      const auto x = outside(0, px), y = outside(1, py), z = outside(2, pz);
      hn::Store(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z))), f, bounds + i);
    }
    // Nearest on top of the stack.
    const std::size_t first = waiting;
    for (std::size_t i = 0; i < kWidth; ++i) {
      if (bounds[i] > limit || node.child[i] == kNoChild) continue;
      std::size_t at = waiting++;
      for (; at > first && stack[at - 1].bound < bounds[i]; --at) stack[at] = stack[at - 1];
      stack[at] = {node.child[i], bounds[i]};
    }
  }
}

/// Squared distance to one triangle, rounded up: the point before this one was nearest to it.
double square_from(const Tree& tree, const Slot& slot, const double* point) {
  const Doubles d;
  HWY_ALIGN double squares[kWidth];
  const std::size_t lane = slot.lane / hn::Lanes(d) * hn::Lanes(d);
  hn::Store(triangle_squares(tree.leaves[slot.leaf], lane, point), d, squares);
  return squares[slot.lane - lane];
}

void search_block(const Tree& tree, const double* points, std::size_t count, const Slot* hints, Found* found) {
  double start = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; ++i) {
    const double* point = points + 3 * i;
    if (hints != nullptr) {
      start = square_from(tree, hints[i], point);
    } else if (i > 0) {
      start = square_from(tree, found[i - 1].slot, point);
    }
    found[i] = {};
    search_point(tree, point, start, &found[i]);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace abbe::surface
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe::surface {

HWY_EXPORT(search_block);

void search_block(const Tree& tree, const double* points, std::size_t count, const Slot* hints, Found* found) {
  HWY_DYNAMIC_DISPATCH(search_block)(tree, points, count, hints, found);
}

}  // namespace abbe::surface
#endif
