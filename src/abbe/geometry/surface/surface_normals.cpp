#include "abbe/geometry/surface/surface_normals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>

#include "abbe/geometry/parallel_blocks.h"

namespace abbe::surface {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kBlock = 16384;

template <class Work>
void for_each_triangle(const TriangleMesh& mesh, int threads, const Work& work) {
  const std::size_t count = static_cast<std::size_t>(mesh.size());
  for_each_block((count + kBlock - 1) / kBlock, threads, [&](std::size_t block) {
    for (std::size_t t = block * kBlock; t < std::min(count, (block + 1) * kBlock); ++t) work(t);
  });
}

Vector3d unit_or_zero(const Vector3d& v) {
  const double length = v.norm();
  return length > 0 ? Vector3d(v / length) : Vector3d(Vector3d::Zero());
}

/// [vertices] the first vertex at the same place.
std::vector<std::uint32_t> first_at_place(const TriangleMesh& mesh) {
  const std::size_t count = static_cast<std::size_t>(mesh.vertices.cols());
  const std::size_t mask = std::bit_ceil(2 * count + 1) - 1;
  std::vector<std::uint32_t> table(mask + 1, kNobody), first(count);
  for (std::size_t v = 0; v < count; ++v) {
    std::uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {
      // Both zeros are the same place.
      hash ^= std::bit_cast<std::uint64_t>(mesh.vertices(k, static_cast<Eigen::Index>(v)) + 0.0);
      hash *= 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    std::size_t at = hash & mask;
    while (table[at] != kNobody && mesh.vertices.col(table[at]) != mesh.vertices.col(static_cast<Eigen::Index>(v))) {
      at = (at + 1) & mask;
    }
    if (table[at] == kNobody) table[at] = static_cast<std::uint32_t>(v);
    first[v] = table[at];
  }
  return first;
}

/// One side of a triangle.
struct Side {
  std::uint32_t other = 0;  ///< the larger of its two vertices
  std::uint32_t triangle = 0;
  std::uint32_t which = 0;
};

/// Joins the faces that share an edge: sides are sorted into the bucket of their smaller vertex.
void join_faces(std::size_t vertices, Normals* normals) {
  std::vector<std::uint32_t> begin(vertices + 1, 0);
  const auto ends = [&](std::size_t t, std::size_t which) {
    const std::uint32_t u = normals->welded[t][which], v = normals->welded[t][(which + 1) % 3];
    return std::pair{std::min(u, v), std::max(u, v)};
  };
  for (std::size_t t = 0; t < normals->welded.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = ends(t, k);
      if (low != high) ++begin[low + 1];
    }
  }
  for (std::size_t v = 0; v < vertices; ++v) begin[v + 1] += begin[v];
  std::vector<Side> sides(begin[vertices]);
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t t = 0; t < normals->welded.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = ends(t, k);
      if (low != high) sides[next[low]++] = {high, static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(k)};
    }
  }
  normals->neighbour.assign(normals->welded.size(), {kNobody, kNobody, kNobody});
  for (std::size_t v = 0; v < vertices; ++v) {
    const auto first = sides.begin() + begin[v], end = sides.begin() + begin[v + 1];
    std::sort(first, end, [](const Side& a, const Side& b) {
      return a.other != b.other ? a.other < b.other : a.triangle < b.triangle;
    });
    for (auto from = first; from != end;) {
      auto to = from;
      while (to != end && to->other == from->other) ++to;
      if (to - from == 2) {
        normals->neighbour[from->triangle][from->which] = from[1].triangle;
        normals->neighbour[from[1].triangle][from[1].which] = from->triangle;
      } else if (to - from == 1) {
        normals->border_vertex[v] = normals->border_vertex[from->other] = 1;
      } else {
        Vector3d sum = Vector3d::Zero();
        for (auto side = from; side != to; ++side) sum += normals->face[side->triangle];
        for (auto side = from; side != to; ++side) {
          normals->neighbour[side->triangle][side->which] =
              Normals::kCrowded + static_cast<std::uint32_t>(normals->crowded.size());
        }
        normals->crowded.push_back(unit_or_zero(sum));
      }
      from = to;
    }
  }
}

/// A triangle without area takes the mean normal of its neighbours: an edge beside it lies between real faces.
void fill_flat_faces(const std::vector<std::uint32_t>& flat, Normals* normals) {
  // Rows of such triangles fill up from their ends.
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<Vector3d> filled;
    for (const std::uint32_t t : flat) {
      Vector3d sum = Vector3d::Zero();
      for (const std::uint32_t n : normals->neighbour[t]) {
        if (n != kNobody) sum += n >= Normals::kCrowded ? normals->crowded[n - Normals::kCrowded] : normals->face[n];
      }
      filled.push_back(unit_or_zero(sum));
    }
    for (std::size_t i = 0; i < flat.size(); ++i) normals->face[flat[i]] = filled[i];
  }
}

}  // namespace

Vector3d Normals::edge(std::uint32_t triangle, std::size_t which) const {
  const std::uint32_t other = neighbour[triangle][which];
  if (other == kNobody) return face[triangle];
  if (other >= kCrowded) return crowded[other - kCrowded];
  return unit_or_zero(face[triangle] + face[other]);
}

Normals surface_normals(const TriangleMesh& mesh, int threads) {
  const std::size_t triangles = static_cast<std::size_t>(mesh.size());
  const std::size_t vertices = static_cast<std::size_t>(mesh.vertices.cols());
  Normals normals;
  const std::vector<std::uint32_t> first = first_at_place(mesh);
  normals.welded.resize(triangles);
  normals.face.resize(triangles);
  std::vector<std::array<float, 3>> angles(triangles);
  for_each_triangle(mesh, threads, [&](std::size_t t) {
    const Eigen::Index i = static_cast<Eigen::Index>(t);
    std::array<Vector3d, 3> corner, side;
    for (int k = 0; k < 3; ++k) {
      corner[static_cast<std::size_t>(k)] = mesh.corner(i, k);
      normals.welded[t][static_cast<std::size_t>(k)] = first[mesh.triangles(k, i)];
    }
    for (std::size_t k = 0; k < 3; ++k) side[k] = corner[(k + 1) % 3] - corner[k];
    using Extended = Eigen::Matrix<long double, 3, 1>;
    const Extended ab = corner[1].cast<long double>() - corner[0].cast<long double>();
    const Extended ac = corner[2].cast<long double>() - corner[0].cast<long double>();
    const Extended across = ab.cross(ac);
    const long double length = across.norm();
    if (length > 0) {
      normals.face[t] = (across / length).cast<double>();
    } else {
      normals.face[t].setZero();
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d before = -side[(k + 2) % 3];
      angles[t][k] = length > 0 ? static_cast<float>(std::atan2(static_cast<double>(length), side[k].dot(before))) : 0;
    }
  });
  std::vector<std::uint32_t> flat;
  normals.vertex.assign(vertices, Vector3d::Zero());
  for (std::size_t t = 0; t < triangles; ++t) {
    if (normals.face[t].isZero(0)) flat.push_back(static_cast<std::uint32_t>(t));
    for (std::size_t k = 0; k < 3; ++k) {
      normals.vertex[normals.welded[t][k]] += static_cast<double>(angles[t][k]) * normals.face[t];
    }
  }
  for (Vector3d& normal : normals.vertex) normal = unit_or_zero(normal);
  normals.border_vertex.assign(vertices, 0);
  join_faces(vertices, &normals);
  if (!flat.empty()) fill_flat_faces(flat, &normals);
  return normals;
}

}  // namespace abbe::surface
