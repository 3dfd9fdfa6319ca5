// Vectors are kept in structures here, which the sizeless vectors of SVE and RISC-V do not allow (as in errors/).
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)

#include <algorithm>
#include <bit>
#include <cmath>

#include "abbe/geometry/surface/surface_tree.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "abbe/geometry/surface/surface_tree_search.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace abbe::surface {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kWidth>;
using Vector = hn::Vec<Floats>;

constexpr std::size_t kMostLanes = 16;  ///< of boxes of a list

struct Vectors {
  Vector x, y, z;
};
HWY_INLINE Vectors load(const std::array<Leaf::Row, 3>& rows, std::size_t lane) {
  const Floats f;
  return {hn::Load(f, rows[0].data() + lane), hn::Load(f, rows[1].data() + lane), hn::Load(f, rows[2].data() + lane)};
}
HWY_INLINE Vectors minus(const Vectors& a, const Vectors& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vector dot(const Vectors& a, const Vectors& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
  return {hn::NegMulAdd(a.z, b.y, hn::Mul(a.y, b.z)), hn::NegMulAdd(a.x, b.z, hn::Mul(a.z, b.x)),
          hn::NegMulAdd(a.y, b.x, hn::Mul(a.x, b.y))};
}

/// Square of the height of a triangle over its longest side from which on its normal is sure in single precision.
constexpr float kStout = 0.2f * 0.2f;

/// From the nearest point of an edge to a point that is given from the beginning of the edge.
HWY_INLINE Vectors from_edge(const Vectors& from_start, const Vectors& edge) {
  const Floats f;
  // An edge without length is where it begins.
  const Vector along = hn::Div(dot(from_start, edge), hn::Max(dot(edge, edge), hn::Set(f, 1e-30f)));
  const Vector t = hn::Min(hn::Max(along, hn::Zero(f)), hn::Set(f, 1.0f));
  return {hn::NegMulAdd(t, edge.x, from_start.x), hn::NegMulAdd(t, edge.y, from_start.y),
          hn::NegMulAdd(t, edge.z, from_start.z)};
}
template <class Mask>
HWY_INLINE Vectors choose(Mask mask, const Vectors& yes, const Vectors& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}

/// Squared distances of a point to triangles, in the unit of a leaf. The roots of the first are too large, those of the
/// second too small, by no more than the slack of visit_leaf().
struct Squares {
  Vector lowest, highest;
};

/// Of the triangles of a leaf from `lane` on, for the distances that nearest_place() has in double precision. They
/// differ only where a triangle is so thin that its normal is not sure in single precision: it may be as near as its
/// plane seems, and is no farther than its edges.
/// @param point  in the unit of the leaf, about its centre
HWY_INLINE Squares triangle_squares(const Leaf& leaf, std::size_t lane, const float* point) {
  const Floats f;
  const Vectors p = {hn::Set(f, point[0]), hn::Set(f, point[1]), hn::Set(f, point[2])};
  const Vectors ap = minus(p, load(leaf.corner, lane)), ab = load(leaf.edge_ab, lane), ac = load(leaf.edge_ac, lane);
  const Vectors bp = minus(ap, ab), bc = minus(ac, ab), normal = cross(ab, ac);
  Vectors nearest = from_edge(ap, ab);
  Vector square = dot(nearest, nearest);
  const auto take = [&](const Vectors& rest) HWY_ATTR {
    const Vector its_square = dot(rest, rest);
    nearest = choose(hn::Lt(its_square, square), rest, nearest);
    square = hn::Min(square, its_square);
  };
  take(from_edge(ap, ac));
  take(from_edge(bp, bc));
  const Vector over_ab = dot(normal, cross(ab, ap)), over_ac = dot(normal, cross(ap, ac)),
               over_bc = dot(normal, cross(bc, bp)), length = dot(normal, normal);
  const auto inside =
      hn::And(hn::Ge(hn::Min(hn::Min(over_ab, over_ac), over_bc), hn::Zero(f)), hn::Gt(length, hn::Set(f, 1e-30f)));
  const Vector height = dot(normal, nearest);
  const Vector lowest = hn::IfThenElse(inside, hn::Min(hn::Div(hn::Mul(height, height), length), square), square);
  const Vector longest = hn::Max(hn::Max(dot(ab, ab), dot(ac, ac)), dot(bc, bc));
  const auto stout = hn::Gt(length, hn::Mul(hn::Set(f, kStout), hn::Mul(longest, longest)));
  return {lowest, hn::IfThenElse(stout, lowest, square)};
}

/// Bit of each lane from `lane` on.
template <class D>
HWY_INLINE std::uint64_t bits_of(D d, hn::Mask<D> mask, std::size_t lane) {
  std::array<std::uint8_t, 8> bytes{};
  hn::StoreMaskBits(d, mask, bytes.data());
  return static_cast<std::uint64_t>(bytes[0] | bytes[1] << 8) << lane;
}

/// More than the rounding of triangle_squares(), per extent of the leaf and distance from its centre.
constexpr double kSlack = 64 * 0x1p-23;

/// Largest single-precision bound that may still hold something as near as `square`: the rounding of the search in
/// single precision is below 2^-20 of it.
HWY_INLINE float bound_of(double square) { return static_cast<float>(std::min(square * 1.000002, 3e38)); }

/// A triangle that may be the nearest.
struct Candidate {
  double lowest;  ///< it is no nearer than this, mm
  std::uint32_t leaf, lane;
};

/// What is known of the triangle nearest to a point while it is searched. Most of the work is done in single precision;
/// what may be the nearest after that is looked at in double precision.
struct Search {
  static constexpr std::size_t kMost = 12;
  double reach = std::numeric_limits<double>::infinity();  ///< the nearest is no farther than this, mm
  std::uint32_t leaf = kNoChild;                           ///< that says so
  std::uint32_t count = 0;
  std::array<Candidate, kMost> candidates;
  Found best;  ///< of those that were candidates

  void restart() {
    reach = std::numeric_limits<double>::infinity();
    leaf = kNoChild;
    count = 0;
    best.place.square = std::numeric_limits<double>::infinity();
  }
};

/// Looks at the candidates in double precision.
void settle(const Tree& tree, const double* point, Search* search) {
  Found& best = search->best;
  while (search->count > 0) {
    // The nearest first, so that most others need not be looked at.
    std::size_t next = 0;
    for (std::size_t i = 1; i < search->count; ++i) {
      if (search->candidates[i].lowest < search->candidates[next].lowest) next = i;
    }
    const Candidate candidate = search->candidates[next];
    if (candidate.lowest > search->reach) break;
    search->candidates[next] = search->candidates[--search->count];
    const Leaf& leaf = tree.leaves[candidate.leaf];
    const Place place = nearest_place(tree, leaf.first + candidate.lane, point);
    const std::uint32_t triangle = leaf.index[candidate.lane];
    if (place.square < best.place.square || (place.square == best.place.square && triangle < best.triangle)) {
      best = {place, triangle, candidate.leaf};
      const double distance = std::sqrt(place.square) * (1 + 1e-9);
      if (distance < search->reach) {
        search->reach = distance;
        search->leaf = candidate.leaf;
      }
    }
  }
  search->count = 0;
}

/// Looks at all triangles of a leaf in single precision.
void visit_leaf(const Tree& tree, std::uint32_t number, const double* point, Search* search) {
  // Farther coordinates would overflow; nearer ones are only more cautious.
  constexpr double kFar = 1e17;
  const Floats f;
  const Leaf& leaf = tree.leaves[number];
  float local[3];
  double away = 2;
  for (std::size_t k = 0; k < 3; ++k) {
    const double scaled = std::min(std::max((point[k] - leaf.centre[k]) * leaf.inverse_scale, -kFar), kFar);
    local[k] = static_cast<float>(scaled);
    away += std::abs(scaled);
  }
  // What the candidates are made of comes while they are found.
  __builtin_prefetch(&tree.corners[leaf.first]);
  __builtin_prefetch(&tree.corners[leaf.first + leaf.count - 1]);
  const double slack = kSlack * away, scale = 1 / leaf.inverse_scale;
  HWY_ALIGN float lowest[kWidth];
  const std::uint64_t filled = (std::uint64_t{1} << leaf.count) - 1;
  Vector highest = hn::Set(f, 3e38f);
  // Lanes beyond the last repeat one.
  for (std::size_t lane = 0; lane < kWidth; lane += hn::Lanes(f)) {
    const Squares some = triangle_squares(leaf, lane, local);
    hn::Store(some.lowest, f, lowest + lane);
    highest = hn::Min(highest, some.highest);
  }
  if (away < kFar) {
    const double root = std::sqrt(hn::GetLane(hn::MinOfLanes(f, highest)));
    const double farthest = (root + slack) * scale;
    if (farthest < search->reach) {
      search->reach = farthest;
      search->leaf = number;
    }
  }
  const double reach = search->reach * leaf.inverse_scale + slack;
  const Vector bound = hn::Set(f, bound_of(reach * reach));
  std::uint64_t near = 0;
  for (std::size_t lane = 0; lane < kWidth; lane += hn::Lanes(f)) {
    near |= bits_of(f, hn::Le(hn::Load(f, lowest + lane), bound), lane);
  }
  for (near &= filled; near != 0; near &= near - 1) {
    if (search->count == Search::kMost) settle(tree, point, search);
    const std::uint32_t lane = static_cast<std::uint32_t>(std::countr_zero(near));
    const double root = std::sqrt(lowest[lane]);
    search->candidates[search->count++] = {(root - slack) * scale, number, lane};
    for (const std::uint32_t corner : tree.corners[leaf.first + lane]) {
      __builtin_prefetch(&tree.vertices[corner & ~Tree::kNeedle]);
    }
  }
}

/// A box in single precision; a point is a box without extent.
struct Region {
  std::array<float, 3> low, high;
};
Region region_of(const double* point) {
  Region region;
  // Farther coordinates would overflow; nearer ones are only more cautious.
  for (std::size_t k = 0; k < 3; ++k) region.low[k] = static_cast<float>(std::min(std::max(point[k], -1e18), 1e18));
  region.high = region.low;
  return region;
}

/// Squared distances of a region from boxes, [axis] their low and high sides. It does not fall when the region shrinks,
/// roundings included.
template <class D>
HWY_INLINE hn::Vec<D> box_squares(D f, const std::array<const float*, 3>& low, const std::array<const float*, 3>& high,
                                  const Region& region) {
  const auto outside = [&](std::size_t axis) HWY_ATTR {
    return hn::Max(hn::Max(hn::Sub(hn::Load(f, low[axis]), hn::Set(f, region.high[axis])),
                           hn::Sub(hn::Set(f, region.low[axis]), hn::Load(f, high[axis]))),
                   hn::Zero(f));
  };
  const auto x = outside(0), y = outside(1), z = outside(2);
  return hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
}

/// Children of a node within reach.
/// @param bounds  [kWidth] filled, aligned
HWY_INLINE std::uint64_t near_children(const Node& node, const Region& region, float limit, float* bounds) {
  const Floats f;
  std::uint64_t near = 0;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(f)) {
    const auto squares = box_squares(f, {&node.low[0][i], &node.low[1][i], &node.low[2][i]},
                                     {&node.high[0][i], &node.high[1][i], &node.high[2][i]}, region);
    hn::Store(squares, f, bounds + i);
    near |= bits_of(f, hn::Le(squares, hn::Set(f, limit)), i);
  }
  return near;
}

struct Waiting {
  std::uint32_t child;
  float bound;
};

/// Puts the nearest on top of those from `first` on.
HWY_INLINE void wait(const Waiting& next, std::size_t first, Waiting* stack, std::size_t* waiting) {
  std::size_t at = (*waiting)++;
  for (; at > first && stack[at - 1].bound < next.bound; --at) stack[at] = stack[at - 1];
  stack[at] = next;
}

/// Searches what waits on the stack and everything below.
/// @param visited  a leaf that need not be visited
void search_stack(const Tree& tree, const double* point, const Region& region, float limit, std::uint32_t visited,
                  Waiting* stack, std::size_t waiting, Search* search) {
  limit = std::min(limit, bound_of(search->reach * search->reach));
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    if (next.bound > limit) continue;
    if ((next.child & kLeaf) != 0) {
      if (next.child == visited) continue;
      visit_leaf(tree, next.child & ~kLeaf, point, search);
      limit = std::min(limit, bound_of(search->reach * search->reach));
      continue;
    }
    const Node& node = tree.nodes[next.child];
    HWY_ALIGN float bounds[kWidth];
    const std::size_t first = waiting;
    for (std::uint64_t near = near_children(node, region, limit, bounds); near != 0; near &= near - 1) {
      const std::size_t i = static_cast<std::size_t>(std::countr_zero(near));
      wait({node.child[i], bounds[i]}, first, stack, &waiting);
    }
  }
}

constexpr std::size_t kListed = 64;     ///< nodes and leaves that a list holds
constexpr std::size_t kStack = 8 * 64;  ///< at most seven more per level, of which there are fewer than 56

/// @param hint  a leaf that may be near, or kNoChild
void search_point(const Tree& tree, const double* point, std::uint32_t hint, Search* search) {
  Waiting stack[kStack];
  stack[0] = {0, 0};
  if (hint != kNoChild) visit_leaf(tree, hint, point, search);
  search_stack(tree, point, region_of(point), std::numeric_limits<float>::max(),
               hint == kNoChild ? kNoChild : kLeaf + hint, stack, 1, search);
}

/// Nodes and leaves with all that is within reach of a group of points.
struct List {
  alignas(64) std::array<std::array<float, kListed>, 3> low, high;  ///< [axis][entry] mm, about Tree::centre
  std::array<std::uint32_t, kListed> child;
  std::size_t size = 0;  ///< filled up to whole vectors with boxes that nothing is near to
};

/// As deep in the tree as they fit into the list.
void list_near(const Tree& tree, const Region& region, float limit, List* list) {
  struct Entry {
    std::uint32_t child, node, lane;
  };
  const auto append_children = [&](std::uint32_t number, Entry* to) HWY_ATTR {
    const Node& node = tree.nodes[number];
    HWY_ALIGN float bounds[kWidth];
    std::size_t count = 0;
    for (std::uint64_t near = near_children(node, region, limit, bounds); near != 0; near &= near - 1) {
      const std::uint32_t i = static_cast<std::uint32_t>(std::countr_zero(near));
      to[count++] = {node.child[i], number, i};
    }
    return count;
  };
  std::array<Entry, kListed> these, below;
  std::size_t size = append_children(0, these.data());
  for (bool deeper = true; deeper;) {
    deeper = false;
    std::size_t next = 0;
    for (std::size_t i = 0; i < size; ++i) {
      if ((these[i].child & kLeaf) != 0 || next + kWidth + (size - i - 1) > kListed) {
        below[next++] = these[i];
      } else {
        next += append_children(these[i].child, below.data() + next);
        deeper = true;
      }
    }
    std::swap(these, below);
    size = next;
  }
  for (std::size_t i = 0; i < size; ++i) {
    const Node& node = tree.nodes[these[i].node];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      list->low[axis][i] = node.low[axis][these[i].lane];
      list->high[axis][i] = node.high[axis][these[i].lane];
    }
    list->child[i] = these[i].child;
    if ((these[i].child & kLeaf) == 0) continue;
    // What is not in the cache comes while the first points are searched.
    const char* const leaf = reinterpret_cast<const char*>(&tree.leaves[these[i].child & ~kLeaf]);
    for (std::size_t byte = 0; byte < sizeof(Leaf); byte += 64) __builtin_prefetch(leaf + byte);
  }
  for (; size % kMostLanes != 0; ++size) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      list->low[axis][size] = std::numeric_limits<float>::infinity();
      list->high[axis][size] = -std::numeric_limits<float>::infinity();
    }
  }
  list->size = size;
}

/// @param limit    bound of the reach for which the list was made
/// @param visited  a leaf that need not be visited
void search_list(const Tree& tree, const List& list, const double* point, float limit, std::uint32_t visited,
                 Search* search) {
  const hn::CappedTag<float, kMostLanes> f;
  const Region region = region_of(point);
  alignas(64) std::array<float, kListed> squares;
  auto least = hn::Set(f, std::numeric_limits<float>::max());
  for (std::size_t i = 0; i < list.size; i += hn::Lanes(f)) {
    const auto some = box_squares(f, {&list.low[0][i], &list.low[1][i], &list.low[2][i]},
                                  {&list.high[0][i], &list.high[1][i], &list.high[2][i]}, region);
    hn::Store(some, f, squares.data() + i);
    least = hn::Min(least, some);
  }
  const auto within = [&](float bound) HWY_ATTR {
    std::uint64_t near = 0;
    for (std::size_t i = 0; i < list.size; i += hn::Lanes(f)) {
      near |= bits_of(f, hn::Le(hn::Load(f, squares.data() + i), hn::Set(f, bound)), i);
    }
    return near;
  };
  Waiting stack[kStack];
  std::size_t waiting = 0;
  limit = std::min(limit, bound_of(search->reach * search->reach));
  // The nearest box first: after it few others are within reach.
  const float nearest = hn::GetLane(hn::MinOfLanes(f, least));
  if (nearest > limit) return;
  const std::size_t first = static_cast<std::size_t>(std::countr_zero(within(nearest)));
  if (list.child[first] != visited) {
    stack[waiting++] = {list.child[first], nearest};
    search_stack(tree, point, region, limit, visited, stack, waiting, search);
    limit = std::min(limit, bound_of(search->reach * search->reach));
  }
  waiting = 0;
  for (std::uint64_t near = within(limit) & ~(std::uint64_t{1} << first); near != 0; near &= near - 1) {
    const std::size_t i = static_cast<std::size_t>(std::countr_zero(near));
    if (list.child[i] != visited) wait({list.child[i], squares[i]}, 0, stack, &waiting);
  }
  search_stack(tree, point, region, limit, visited, stack, waiting, search);
}

constexpr std::size_t kGroup = 32;  ///< points that share a list
constexpr std::size_t kAlone = 4;   ///< points for which no list is made

/// Distance in which all of a group have something, from that of one of them.
double common_reach(const double* points, std::size_t count, std::size_t one, double its_reach) {
  double farthest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double away = points[3 * i + k] - points[3 * one + k];
      square += away * away;
    }
    farthest = std::max(farthest, square);
  }
  return std::sqrt(farthest) + its_reach;
}

Region box_of(const double* points, std::size_t count) {
  Region box = region_of(points);
  for (std::size_t i = 1; i < count; ++i) {
    const Region point = region_of(points + 3 * i);
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], point.low[k]);
      box.high[k] = std::max(box.high[k], point.low[k]);
    }
  }
  return box;
}

/// Neighbours. Nothing that is nearer to one of them than its bound is missing in the list, so that each finds the
/// triangle that it would find alone.
/// @param previous  a leaf that may be near, or kNoChild
/// @param searches  [count] new
void search_group(const Tree& tree, const double* points, std::size_t count, const std::uint32_t* hints,
                  std::uint32_t previous, Search* searches) {
  if (count < kAlone) {
    for (std::size_t i = 0; i < count; ++i) {
      search_point(tree, points + 3 * i, hints == nullptr ? previous : hints[i], &searches[i]);
      previous = searches[i].leaf;
    }
    return;
  }
  double reach = 0;  // the farthest that any of them has to look
  std::size_t done = count;
  if (hints != nullptr) {
    for (std::size_t i = 0; i < count; ++i) {
      visit_leaf(tree, hints[i], points + 3 * i, &searches[i]);
      reach = std::max(reach, searches[i].reach);
    }
  } else {
    done = count / 2;
    search_point(tree, points + 3 * done, previous, &searches[done]);
    reach = common_reach(points, count, done, searches[done].reach);
  }
  const float limit = bound_of(reach * reach);
  List list;
  list_near(tree, box_of(points, count), limit, &list);
  for (std::size_t i = 0; i < count; ++i) {
    if (i == done) continue;
    const std::uint32_t visited = hints == nullptr ? kNoChild : kLeaf + hints[i];
    search_list(tree, list, points + 3 * i, limit, visited, &searches[i]);
  }
}

void search_block(const Tree& tree, const double* points, std::size_t count, const std::uint32_t* hints, Found* found) {
  std::uint32_t previous = kNoChild;
  std::array<Search, kGroup> searches;
  for (std::size_t first = 0; first < count; first += kGroup) {
    const std::size_t some = std::min(kGroup, count - first);
    for (std::size_t i = 0; i < some; ++i) searches[i].restart();
    search_group(tree, points + 3 * first, some, hints == nullptr ? nullptr : hints + first, previous, searches.data());
    for (std::size_t i = 0; i < some; ++i) {
      settle(tree, points + 3 * (first + i), &searches[i]);
      found[first + i] = searches[i].best;
    }
    previous = found[first + some - 1].leaf;
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace abbe::surface
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe::surface {

HWY_EXPORT(search_block);

void search_block(const Tree& tree, const double* points, std::size_t count, const std::uint32_t* hints, Found* found) {
  HWY_DYNAMIC_DISPATCH(search_block)(tree, points, count, hints, found);
}

}  // namespace abbe::surface
#endif
