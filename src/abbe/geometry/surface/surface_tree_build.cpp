#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/geometry/parallel_blocks.h"
#include "abbe/geometry/surface/surface_tree.h"

namespace abbe::surface {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kBins = 32;
/// Sets of at most this size become one node of full leaves.
constexpr std::size_t kLastNode = kWidth * kWidth;
/// Sets below this size are built by one thread each.
constexpr std::size_t kTask = 8192;
/// Heights of triangles over their longest sides below which they are needles.
constexpr double kThin = 1e-5;
/// Below this level sets are halved by number, so that no arrangement of triangles makes a tree deeper than 40 levels.
constexpr int kLastFreeLevel = 28;

struct Box {
  std::array<float, 3> low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  static constexpr float kFar = std::numeric_limits<float>::infinity();

  void include(const Box& other) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], other.low[k]);
      high[k] = std::max(high[k], other.high[k]);
    }
  }
  /// Half of the surface; 0 for an empty box.
  float area() const {
    if (low[0] > high[0]) return 0;
    const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
    return x * y + y * z + z * x;
  }
};

struct Item {
  Box box;
  std::uint32_t triangle = 0;
  float middle(std::size_t axis) const { return 0.5f * box.low[axis] + 0.5f * box.high[axis]; }
};

using Items = std::pair<std::size_t, std::size_t>;  ///< first, end
std::size_t size_of(const Items& items) { return items.second - items.first; }

float rounded_down(double value) {
  const float nearest = static_cast<float>(value);
  return static_cast<double>(nearest) > value ? std::nextafter(nearest, -Box::kFar) : nearest;
}
float rounded_up(double value) { return -rounded_down(-value); }

/// Zero if the mesh is near the origin; else such a point that subtracting it from a coordinate is exact.
Vector3d centre_of(const Vector3d& low, const Vector3d& high) {
  const Vector3d middle = 0.5 * low + 0.5 * high;
  const double extent = (high - low).maxCoeff();
  if (middle.cwiseAbs().maxCoeff() < 8 * extent || !(extent > 0)) return extent > 0 ? Vector3d::Zero() : middle;
  const double step = std::exp2(std::ceil(std::log2(extent)));
  return (middle / step).array().round().matrix() * step;
}

class Builder {
 public:
  Builder(std::vector<Item>* items, const Tree& tree, const TriangleMesh& mesh)
      : items_(*items), mesh_(mesh), centre_(tree.centre), margin_(std::ldexp(tree.largest, -22)) {}

  struct Part {
    std::vector<Node> nodes;
    std::vector<Leaf> leaves;
    std::vector<std::array<std::uint32_t, 3>> corners;
    std::vector<std::pair<std::uint32_t, Coordinates>> needle_normals;  ///< by the place in `corners`
  };

  /// Appends the node of `items`, and below it everything that is not left to a task.
  /// @param tasks  if not null: large sets become tasks instead of children, marked by their number
  std::uint32_t build(Items items, int level, Part* part, std::vector<Items>* tasks) {
    const std::uint32_t at = static_cast<std::uint32_t>(part->nodes.size());
    part->nodes.emplace_back();
    const std::vector<Items> children = size_of(items) <= kLastNode ? full_leaves(items) : split_in_eight(items, level);
    for (std::size_t i = 0; i < kWidth; ++i) {
      std::uint32_t child = kNoChild;
      Box box;
      if (i < children.size()) {
        for (std::size_t k = children[i].first; k < children[i].second; ++k) box.include(items_[k].box);
        if (size_of(children[i]) <= kWidth) {
          child = kLeaf + leaf(children[i], part);
        } else if (tasks != nullptr && size_of(children[i]) <= kTask) {
          child = static_cast<std::uint32_t>(tasks->size());
          tasks->push_back(children[i]);
          task_children_.push_back({at, i, level + 1});
        } else {
          child = build(children[i], level + 1, part, tasks);
        }
      }
      Node& node = part->nodes[at];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        node.low[axis][i] = rounded_down(static_cast<double>(box.low[axis]) - margin_);
        node.high[axis][i] = rounded_up(static_cast<double>(box.high[axis]) + margin_);
      }
      node.child[i] = child;
    }
    return at;
  }

  /// Where the root of a task belongs.
  struct TaskChild {
    std::uint32_t node = 0;
    std::size_t child = 0;
    int level = 0;
  };
  const std::vector<TaskChild>& task_children() const { return task_children_; }

 private:
  Box middles(const Items& items) const {
    Box box;
    for (std::size_t i = items.first; i < items.second; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        box.low[k] = std::min(box.low[k], items_[i].middle(k));
        box.high[k] = std::max(box.high[k], items_[i].middle(k));
      }
    }
    return box;
  }
  static std::size_t widest(const Box& box) {
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      if (box.high[k] - box.low[k] > box.high[axis] - box.low[axis]) axis = k;
    }
    return axis;
  }

  /// The two parts hold `left` items and the rest, in order of their middles; equal ones by their number.
  Items split_at(const Items& items, std::size_t axis, std::size_t left) {
    const auto begin = items_.begin();
    std::nth_element(begin + static_cast<std::ptrdiff_t>(items.first),
                     begin + static_cast<std::ptrdiff_t>(items.first + left),
                     begin + static_cast<std::ptrdiff_t>(items.second), [axis](const Item& a, const Item& b) {
                       const float u = a.middle(axis), v = b.middle(axis);
                       return u != v ? u < v : a.triangle < b.triangle;
                     });
    return {items.first, items.first + left};
  }

  /// Where the area of the boxes weighted with their items is smallest.
  std::size_t best_split(const Items& items) {
    const Box centres = middles(items);
    const std::size_t axis = widest(centres);
    const float from = centres.low[axis], width = centres.high[axis] - from;
    const std::size_t half = items.first + size_of(items) / 2;
    if (!(width > 0) || !std::isfinite(width)) return split_at(items, axis, size_of(items) / 2).second;
    const float scale = static_cast<float>(kBins) * 0.99999f / width;
    const auto bin = [&](const Item& item) {
      return std::min(static_cast<std::size_t>((item.middle(axis) - from) * scale), kBins - 1);
    };
    std::array<Box, kBins> boxes;
    std::array<std::size_t, kBins> counts{};
    for (std::size_t i = items.first; i < items.second; ++i) {
      const std::size_t b = bin(items_[i]);
      boxes[b].include(items_[i].box);
      ++counts[b];
    }
    std::array<float, kBins> cost_right{};
    Box right;
    std::size_t count = 0;
    for (std::size_t b = kBins - 1; b > 0; --b) {
      right.include(boxes[b]);
      count += counts[b];
      cost_right[b] = right.area() * static_cast<float>(count);
    }
    Box left;
    count = 0;
    std::size_t best = 0;
    float lowest = Box::kFar;
    for (std::size_t b = 1; b < kBins; ++b) {
      left.include(boxes[b - 1]);
      count += counts[b - 1];
      const float cost = left.area() * static_cast<float>(count) + cost_right[b];
      if (count > 0 && count < size_of(items) && cost < lowest) {
        lowest = cost;
        best = b;
      }
    }
    if (best == 0) return split_at(items, axis, half - items.first).second;
    const auto begin = items_.begin();
    const auto middle = std::partition(begin + static_cast<std::ptrdiff_t>(items.first),
                                       begin + static_cast<std::ptrdiff_t>(items.second),
                                       [&](const Item& item) { return bin(item) < best; });
    return static_cast<std::size_t>(middle - begin);
  }

  std::vector<Items> split_in_eight(const Items& items, int level) {
    std::vector<Items> parts{items};
    while (parts.size() < kWidth) {
      const auto largest = std::max_element(parts.begin(), parts.end(),
                                            [](const Items& a, const Items& b) { return size_of(a) < size_of(b); });
      if (size_of(*largest) <= kWidth) break;
      const Items whole = *largest;
      const std::size_t middle = level > kLastFreeLevel
                                     ? split_at(whole, widest(middles(whole)), size_of(whole) / 2).second
                                     : best_split(whole);
      *largest = {whole.first, middle};
      parts.insert(largest + 1, {middle, whole.second});
    }
    return parts;
  }

  std::vector<Items> full_leaves(const Items& items) {
    const std::size_t leaves = (size_of(items) + kWidth - 1) / kWidth;
    if (leaves == 1) return {items};
    const std::size_t left = leaves / 2 * kWidth;
    const Items first = split_at(items, widest(middles(items)), left);
    std::vector<Items> parts = full_leaves(first);
    for (const Items& part : full_leaves({first.second, items.second})) parts.push_back(part);
    return parts;
  }

  /// Appends a triangle with the numbers of its vertices in the mesh; of a needle its normal too.
  void add_corners(std::uint32_t triangle, const std::array<Vector3d, 3>& corner, Part* part) const {
    std::array<std::uint32_t, 3> numbers{};
    for (std::size_t k = 0; k < 3; ++k) numbers[k] = mesh_.triangles(static_cast<Eigen::Index>(k), triangle);
    const Vector3d ab = corner[1] - corner[0], ac = corner[2] - corner[0];
    const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    const double area = ab.cross(ac).norm();
    // Of a triangle this thin the normal is rounded so far that it counts; very small ones have squares near zero.
    if (!(area > kThin * longest) || !(longest > 1e-120) || !(longest < 1e120)) {
      const Eigen::Matrix<long double, 3, 1> u = corner[1].cast<long double>() - corner[0].cast<long double>(),
                                             v = corner[2].cast<long double>() - corner[0].cast<long double>();
      const Eigen::Matrix<long double, 3, 1> across = u.cross(v);
      const long double length = across.norm();
      const Vector3d normal = length > 0 ? Vector3d((across / length).cast<double>()) : Vector3d(Vector3d::Zero());
      part->needle_normals.emplace_back(static_cast<std::uint32_t>(part->corners.size()),
                                        Coordinates{normal.x(), normal.y(), normal.z()});
    }
    part->corners.push_back(numbers);
  }

  std::uint32_t leaf(const Items& items, Part* part) const {
    Leaf& leaf = part->leaves.emplace_back();
    leaf.first = static_cast<std::uint32_t>(part->corners.size());
    leaf.count = static_cast<std::uint32_t>(size_of(items));
    Box box;
    for (std::size_t i = items.first; i < items.second; ++i) box.include(items_[i].box);
    double extent = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      leaf.centre[k] = 0.5 * static_cast<double>(box.low[k]) + 0.5 * static_cast<double>(box.high[k]);
      extent = std::max(extent, 0.5 * (static_cast<double>(box.high[k]) - static_cast<double>(box.low[k])));
    }
    // A triangle without any extent needs no scale.
    leaf.inverse_scale = extent > 1e-30 ? std::exp2(-std::ceil(std::log2(extent))) : 1;
    const Vector3d centre(leaf.centre[0], leaf.centre[1], leaf.centre[2]);
    for (std::size_t lane = 0; lane < kWidth; ++lane) {
      const std::uint32_t triangle = items_[items.first + std::min(lane, size_of(items) - 1)].triangle;
      std::array<Vector3d, 3> corner;
      for (int k = 0; k < 3; ++k) corner[static_cast<std::size_t>(k)] = mesh_.corner(triangle, k) - centre_;
      if (lane < size_of(items)) add_corners(triangle, corner, part);
      const auto scaled = [&](std::array<Leaf::Row, 3>& rows, const Vector3d& vector) {
        for (std::size_t k = 0; k < 3; ++k) {
          rows[k][lane] = static_cast<float>(vector[static_cast<Eigen::Index>(k)] * leaf.inverse_scale);
        }
      };
      scaled(leaf.corner, corner[0] - centre);
      scaled(leaf.edge_ab, corner[1] - corner[0]);
      scaled(leaf.edge_ac, corner[2] - corner[0]);
      leaf.index[lane] = triangle;
    }
    return static_cast<std::uint32_t>(part->leaves.size() - 1);
  }

  std::vector<Item>& items_;
  const TriangleMesh& mesh_;
  Vector3d centre_;
  double margin_ = 0;
  std::vector<TaskChild> task_children_;
};

/// Vertices in the order in which the leaves name them first.
void number_vertices(const TriangleMesh& mesh, Tree* tree) {
  constexpr std::uint32_t kNew = 0xffffffffu;
  std::vector<std::uint32_t> number(static_cast<std::size_t>(mesh.vertices.cols()), kNew);
  tree->vertices.reserve(number.size());
  for (std::array<std::uint32_t, 3>& corners : tree->corners) {
    for (std::uint32_t& corner : corners) {
      if (number[corner] == kNew) {
        number[corner] = static_cast<std::uint32_t>(tree->vertices.size());
        const Vector3d vertex = mesh.vertices.col(corner) - tree->centre;
        tree->vertices.push_back({vertex.x(), vertex.y(), vertex.z()});
      }
      corner = number[corner];
    }
  }
  for (const auto& [triangle, normal] : tree->needle_normals) tree->corners[triangle][0] |= Tree::kNeedle;
}

/// Appends a part behind the others and corrects its references.
void append(const Builder::Part& part, Tree* tree) {
  const std::uint32_t nodes = static_cast<std::uint32_t>(tree->nodes.size());
  const std::uint32_t leaves = static_cast<std::uint32_t>(tree->leaves.size());
  for (Node node : part.nodes) {
    for (std::uint32_t& child : node.child) {
      if (child != kNoChild) child += (child & kLeaf) != 0 ? leaves : nodes;
    }
    tree->nodes.push_back(node);
  }
  const std::uint32_t triangles = static_cast<std::uint32_t>(tree->corners.size());
  for (Leaf leaf : part.leaves) {
    leaf.first += triangles;
    tree->leaves.push_back(leaf);
  }
  tree->corners.insert(tree->corners.end(), part.corners.begin(), part.corners.end());
  for (const auto& [place, normal] : part.needle_normals) tree->needle_normals.emplace(triangles + place, normal);
}

}  // namespace

Tree build_tree(const TriangleMesh& mesh, int threads) {
  Tree tree;
  const std::size_t count = static_cast<std::size_t>(mesh.size());
  if (count == 0) return tree;
  Vector3d low = mesh.corner(0, 0), high = low;
  for (Eigen::Index t = 0; t < mesh.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      low = low.cwiseMin(mesh.corner(t, k));
      high = high.cwiseMax(mesh.corner(t, k));
    }
  }
  tree.low = low;
  tree.high = high;
  tree.centre = centre_of(low, high);
  tree.largest =
      rounded_up(std::max((low - tree.centre).cwiseAbs().maxCoeff(), (high - tree.centre).cwiseAbs().maxCoeff()));

  std::vector<Item> items(count);
  constexpr std::size_t kBlock = 16384;
  for_each_block((count + kBlock - 1) / kBlock, threads, [&](std::size_t block) {
    for (std::size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) {
      const Eigen::Index t = static_cast<Eigen::Index>(i);
      const Vector3d a = mesh.corner(t, 0) - tree.centre, b = mesh.corner(t, 1) - tree.centre,
                     c = mesh.corner(t, 2) - tree.centre;
      const Vector3d least = a.cwiseMin(b).cwiseMin(c), most = a.cwiseMax(b).cwiseMax(c);
      for (std::size_t k = 0; k < 3; ++k) {
        items[i].box.low[k] = rounded_down(least[static_cast<Eigen::Index>(k)]);
        items[i].box.high[k] = rounded_up(most[static_cast<Eigen::Index>(k)]);
      }
      items[i].triangle = static_cast<std::uint32_t>(i);
    }
  });

  Builder top(&items, tree, mesh);
  Builder::Part upper;
  std::vector<Items> tasks;
  top.build({0, count}, 0, &upper, &tasks);
  std::vector<Builder::Part> parts(tasks.size());
  for_each_block(tasks.size(), threads, [&](std::size_t task) {
    Builder(&items, tree, mesh).build(tasks[task], top.task_children()[task].level, &parts[task], nullptr);
  });
  std::size_t nodes = upper.nodes.size(), leaves = upper.leaves.size();
  for (const Builder::Part& part : parts) {
    nodes += part.nodes.size();
    leaves += part.leaves.size();
  }
  tree.nodes.reserve(nodes);
  tree.leaves.reserve(leaves);
  tree.corners.reserve(count);
  append(upper, &tree);
  for (std::size_t task = 0; task < tasks.size(); ++task) {
    const Builder::TaskChild& child = top.task_children()[task];
    tree.nodes[child.node].child[child.child] = static_cast<std::uint32_t>(tree.nodes.size());
    append(parts[task], &tree);
    parts[task] = {};
  }
  number_vertices(mesh, &tree);
  return tree;
}

}  // namespace abbe::surface
