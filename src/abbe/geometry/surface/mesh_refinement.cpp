#include "abbe/geometry/surface/mesh_refinement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "abbe/geometry/surface/halved_triangle.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Vertices and triangles that grow.
struct Growing {
  std::vector<Vector3d> vertices;
  std::vector<TriangleCorners> triangles;
};

/// Halves every edge longer than that once. @returns whether there was one
bool halve(Growing& mesh, double longest_mm) {
  std::unordered_map<std::uint64_t, std::uint32_t> middles;
  const auto middle_of = [&](std::uint32_t a, std::uint32_t b) -> std::uint32_t {
    if ((mesh.vertices[a] - mesh.vertices[b]).squaredNorm() <= longest_mm * longest_mm) return kNoMiddle;
    const auto [found, is_new] = middles.try_emplace(side_key(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) {
      // Computed before the vector grows.
      const Vector3d middle = (mesh.vertices[a] + mesh.vertices[b]) / 2;
      mesh.vertices.push_back(middle);
    }
    return found->second;
  };
  const auto squared_distance = [&](std::uint32_t a, std::uint32_t b) {
    return (mesh.vertices[a] - mesh.vertices[b]).squaredNorm();
  };
  std::vector<TriangleCorners> result;
  result.reserve(2 * mesh.triangles.size());
  for (const TriangleCorners& t : mesh.triangles) {
    add_halved(t, {middle_of(t[0], t[1]), middle_of(t[1], t[2]), middle_of(t[2], t[0])}, squared_distance,
               [&](const TriangleCorners& part) { result.push_back(part); });
  }
  mesh.triangles = std::move(result);
  return !middles.empty();
}

Growing growing(const TriangleMesh& mesh) {
  Growing result;
  for (Index v = 0; v < mesh.vertices.cols(); ++v) result.vertices.emplace_back(mesh.vertices.col(v));
  for (Index t = 0; t < mesh.size(); ++t) {
    result.triangles.push_back({mesh.triangles(0, t), mesh.triangles(1, t), mesh.triangles(2, t)});
  }
  return result;
}

TriangleMesh fixed(const Growing& mesh) {
  TriangleMesh result;
  result.vertices.resize(3, static_cast<Index>(mesh.vertices.size()));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) result.vertices.col(static_cast<Index>(v)) = mesh.vertices[v];
  result.triangles.resize(3, static_cast<Index>(mesh.triangles.size()));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      result.triangles(k, static_cast<Index>(t)) = mesh.triangles[t][static_cast<std::size_t>(k)];
    }
  }
  return result;
}

}  // namespace

RefinedMesh refined_mesh(const TriangleMesh& mesh, double longest_mm, Index most_triangles) {
  const auto most = static_cast<std::size_t>(most_triangles);
  if (mesh.size() > most_triangles) {
    double longest = 0;
    for (Index t = 0; t < mesh.size(); ++t) {
      for (int k = 0; k < 3; ++k) longest = std::max(longest, (mesh.corner(t, k) - mesh.corner(t, (k + 1) % 3)).norm());
    }
    return {mesh, longest};
  }
  // A triangle with such edges has an area of sqrt(3) / 4 times their square at most.
  double area = 0;
  for (Index t = 0; t < mesh.size(); ++t) {
    area += (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0)).norm() / 2;
  }
  longest_mm = std::max(longest_mm, std::sqrt(area / (0.4331 * static_cast<double>(most_triangles))));
  while (true) {
    Growing finer = growing(mesh);
    while (finer.triangles.size() <= most && halve(finer, longest_mm)) {
    }
    if (finer.triangles.size() <= most) return {fixed(finer), longest_mm};
    longest_mm *= 1.2;
  }
}

TriangleMesh with_separate_faces(const TriangleMesh& mesh, const SurfaceFaces& faces) {
  TriangleMesh result;
  result.triangles.resize(3, mesh.size());
  std::unordered_map<std::uint64_t, std::uint32_t> known;
  std::vector<std::uint32_t> source;
  for (Index t = 0; t < mesh.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t vertex = mesh.triangles(k, t);
      const std::uint64_t key =
          (static_cast<std::uint64_t>(faces.face_of_triangle[static_cast<std::size_t>(t)]) << 32U) | vertex;
      const auto [found, is_new] = known.try_emplace(key, static_cast<std::uint32_t>(source.size()));
      if (is_new) source.push_back(vertex);
      result.triangles(k, t) = found->second;
    }
  }
  result.vertices.resize(3, static_cast<Index>(source.size()));
  for (std::size_t v = 0; v < source.size(); ++v) {
    result.vertices.col(static_cast<Index>(v)) = mesh.vertices.col(static_cast<Index>(source[v]));
  }
  return result;
}

Eigen::Matrix3Xd vertex_normals(const TriangleMesh& mesh) {
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, mesh.vertices.cols());
  for (Index t = 0; t < mesh.size(); ++t) {
    const Vector3d twice = (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
    for (int k = 0; k < 3; ++k) normals.col(static_cast<Index>(mesh.triangles(k, t))) += twice;
  }
  for (Index v = 0; v < normals.cols(); ++v) {
    const double length = normals.col(v).norm();
    if (length > 0) normals.col(v) /= length;
  }
  return normals;
}

}  // namespace abbe
