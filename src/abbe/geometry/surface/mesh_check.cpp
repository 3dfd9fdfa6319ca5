#include "abbe/geometry/surface/mesh_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace abbe {
namespace {

using Corners = std::array<std::uint32_t, 3>;

Corners corners_of(const TriangleMesh& mesh, Eigen::Index triangle) {
  return {mesh.triangles(0, triangle), mesh.triangles(1, triangle), mesh.triangles(2, triangle)};
}

bool repeats_a_vertex(const Corners& c) { return c[0] == c[1] || c[1] == c[2] || c[2] == c[0]; }

/// Records sorted by their smallest vertex without a comparison, then few by few.
template <typename Record>
class ByVertex {
 public:
  /// @param give  give(put) calls put(vertex, record) for every record, the same ones each time
  template <typename Give>
  ByVertex(std::size_t vertices, Give&& give) : begin_(vertices + 1) {
    give([&](std::uint32_t vertex, const Record&) { ++begin_[vertex + std::size_t{1}]; });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    records_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    give([&](std::uint32_t vertex, const Record& record) { records_[next[vertex]++] = record; });
  }

  /// Calls group(vertex, first, last) for every run of records that `same` says are one.
  template <typename Same, typename Group>
  void for_each_group(Same&& same, Group&& group) {
    for (std::size_t vertex = 0; vertex + 1 < begin_.size(); ++vertex) {
      Record* const first = records_.data() + begin_[vertex];
      Record* const last = records_.data() + begin_[vertex + 1];
      std::sort(first, last);
      for (Record* from = first; from != last;) {
        Record* to = from + 1;
        while (to != last && same(*from, *to)) ++to;
        group(static_cast<std::uint32_t>(vertex), from, to);
        from = to;
      }
    }
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<Record> records_;
};

/// Vertices that something joins.
class MergedVertices {
 public:
  explicit MergedVertices(std::size_t vertices) : parent_(vertices), used_(vertices, false) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  void merge(std::uint32_t a, std::uint32_t b) {
    used_[a] = used_[b] = true;
    parent_[root(b)] = root(a);
  }

  std::size_t used() const { return static_cast<std::size_t>(std::count(used_.begin(), used_.end(), true)); }

  std::size_t pieces() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < parent_.size(); ++i) count += used_[i] && parent_[i] == i ? 1 : 0;
    return count;
  }

 private:
  std::uint32_t root(std::uint32_t vertex) {
    while (parent_[vertex] != vertex) {
      parent_[vertex] = parent_[parent_[vertex]];
      vertex = parent_[vertex];
    }
    return vertex;
  }

  std::vector<std::uint32_t> parent_;
  std::vector<bool> used_;
};

void count_edges(const TriangleMesh& mesh, MeshCheck& check) {
  // The other vertex, and whether the triangle runs towards it.
  using Edge = std::pair<std::uint32_t, bool>;
  ByVertex<Edge> edges(check.vertices, [&](const auto& put) {
    for (Eigen::Index i = 0; i < mesh.size(); ++i) {
      const Corners c = corners_of(mesh, i);
      // A triangle that is a segment has no sides that a neighbour could share.
      if (repeats_a_vertex(c)) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = c[k], to = c[(k + 1) % 3];
        put(std::min(from, to), Edge{std::max(from, to), from < to});
      }
    }
  });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> border;
  edges.for_each_group([](const Edge& a, const Edge& b) { return a.first == b.first; },
                       [&](std::uint32_t vertex, const Edge* from, const Edge* to) {
                         ++check.edges;
                         if (to - from == 1) border.emplace_back(vertex, from->first);
                         if (to - from > 2) ++check.branching_edges;
                         if (to - from == 2 && from[0].second == from[1].second) ++check.turned_edges;
                       });
  check.border_edges = border.size();
  if (border.empty()) return;
  MergedVertices merged(check.vertices);
  for (const std::pair<std::uint32_t, std::uint32_t>& edge : border) merged.merge(edge.first, edge.second);
  check.rims = merged.pieces();
}

void count_duplicates(const TriangleMesh& mesh, MeshCheck& check) {
  using Others = std::pair<std::uint32_t, std::uint32_t>;
  ByVertex<Others> triangles(check.vertices, [&](const auto& put) {
    for (Eigen::Index i = 0; i < mesh.size(); ++i) {
      Corners c = corners_of(mesh, i);
      if (repeats_a_vertex(c)) continue;
      std::sort(c.begin(), c.end());
      put(c[0], Others{c[1], c[2]});
    }
  });
  triangles.for_each_group([](const Others& a, const Others& b) { return a == b; },
                           [&](std::uint32_t, const Others* from, const Others* to) {
                             check.duplicate_triangles += static_cast<std::size_t>(to - from - 1);
                           });
}

/// Pieces by merging the vertices of each triangle.
void count_parts(const TriangleMesh& mesh, MeshCheck& check) {
  MergedVertices merged(check.vertices);
  for (Eigen::Index i = 0; i < mesh.size(); ++i) {
    const Corners c = corners_of(mesh, i);
    merged.merge(c[0], c[1]);
    merged.merge(c[0], c[2]);
  }
  check.parts = merged.pieces();
  check.unused_vertices = check.vertices - merged.used();
}

void measure(const TriangleMesh& mesh, MeshCheck& check) {
  Eigen::Array3d lower = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity()), upper = -lower;
  for (Eigen::Index i = 0; i < mesh.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Array3d corner = mesh.corner(i, k).array();
      lower = lower.min(corner);
      upper = upper.max(corner);
    }
  }
  if (mesh.size() == 0) return;
  check.lower = lower.matrix();
  check.upper = upper.matrix();
  const double resolution = 4 * std::numeric_limits<double>::epsilon() * lower.abs().max(upper.abs()).maxCoeff();
  // About the middle, where the terms are smallest.
  const Eigen::Vector3d middle = 0.5 * (check.lower + check.upper);
  double volume = 0;
  for (Eigen::Index i = 0; i < mesh.size(); ++i) {
    const Eigen::Vector3d a = mesh.corner(i, 0) - middle, b = mesh.corner(i, 1) - middle,
                          c = mesh.corner(i, 2) - middle;
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const double twice_area = normal.norm();
    const double longest = std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
    if (twice_area <= resolution * longest) ++check.degenerate_triangles;
    check.area += 0.5 * twice_area;
    volume += a.dot(normal) / 6;
  }
  if (check.encloses_volume()) check.volume = volume;
}

}  // namespace

MeshCheck check_mesh(const TriangleMesh& mesh) {
  MeshCheck check;
  check.triangles = static_cast<std::size_t>(mesh.size());
  check.vertices = static_cast<std::size_t>(mesh.vertices.cols());
  count_edges(mesh, check);
  count_duplicates(mesh, check);
  count_parts(mesh, check);
  measure(mesh, check);
  return check;
}

}  // namespace abbe
