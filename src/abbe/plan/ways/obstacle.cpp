#include "abbe/plan/ways/obstacle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace abbe {

TriangleMesh box_mesh(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d low = from.cwiseMin(to), high = from.cwiseMax(to);
  TriangleMesh mesh;
  mesh.vertices.resize(3, 8);
  for (int corner = 0; corner < 8; ++corner) {
    for (int k = 0; k < 3; ++k) mesh.vertices(k, corner) = (corner >> k & 1) != 0 ? high[k] : low[k];
  }
  mesh.triangles.resize(3, 12);
  mesh.triangles << 0, 1, 4, 5, 0, 1, 2, 3, 0, 2, 1, 3,  //
      2, 2, 5, 7, 1, 5, 6, 6, 4, 4, 3, 7,                //
      1, 3, 6, 6, 4, 4, 3, 7, 2, 6, 5, 5;
  return mesh;
}

TriangleMesh ball_mesh(const Eigen::Vector3d& centre, double radius) {
  // An octahedron whose triangles are divided into four, four times, with all corners on a sphere.
  using Corners = std::array<std::uint32_t, 3>;
  std::vector<Eigen::Vector3d> corners = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<Corners> faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  constexpr int kDivisions = 4;
  for (int division = 0; division < kDivisions; ++division) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [place, is_new] =
          middles.emplace(std::pair(std::min(a, b), std::max(a, b)), static_cast<std::uint32_t>(corners.size()));
      if (is_new) corners.push_back((corners[a] + corners[b]).normalized());
      return place->second;
    };
    std::vector<Corners> divided;
    for (const Corners& face : faces) {
      const Corners m = {middle(face[0], face[1]), middle(face[1], face[2]), middle(face[2], face[0])};
      divided.push_back({face[0], m[0], m[2]});
      divided.push_back({m[0], face[1], m[1]});
      divided.push_back({m[2], m[1], face[2]});
      divided.push_back(m);
    }
    faces = std::move(divided);
  }
  double nearest = 1;
  for (const Corners& face : faces) {
    const Eigen::Vector3d normal =
        (corners[face[1]] - corners[face[0]]).cross(corners[face[2]] - corners[face[0]]).normalized();
    nearest = std::min(nearest, normal.dot(corners[face[0]]));
  }
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(corners.size()));
  for (std::size_t k = 0; k < corners.size(); ++k) {
    mesh.vertices.col(static_cast<Eigen::Index>(k)) = centre + radius / nearest * corners[k];
  }
  mesh.triangles.resize(3, static_cast<Eigen::Index>(faces.size()));
  for (std::size_t k = 0; k < faces.size(); ++k) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      mesh.triangles(i, static_cast<Eigen::Index>(k)) = faces[k][static_cast<std::size_t>(i)];
    }
  }
  return mesh;
}

}  // namespace abbe
