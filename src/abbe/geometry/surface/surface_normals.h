#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "abbe/geometry/surface/triangle_mesh.h"

/// Inside of ClosestPointFinder: what gives a distance its sign. Not an interface.
namespace abbe::surface {

inline constexpr std::uint32_t kNobody = 0xffffffffu;

/// Normals of the faces, edges and vertices of a mesh whose coinciding vertices count as one.
struct Normals {
  std::vector<Eigen::Vector3d>
      face;  ///< [triangles] unit; of a triangle without area the mean of its neighbours', or zero
  std::vector<Eigen::Vector3d> vertex;  ///< [vertices] unit, weighted with angles; zero at a vertex that no area uses
  std::vector<std::uint8_t> border_vertex;                ///< [vertices]
  std::vector<std::array<std::uint32_t, 3>> welded;       ///< [triangles] vertices, the first of those at one place
  std::vector<std::array<std::uint32_t, 3>> neighbour;    ///< [triangles] over ab, bc, ca; kNobody at the border; an
                                                          ///< edge of more than two faces: see `crowded`
  static constexpr std::uint32_t kCrowded = 0x80000000u;  ///< neighbour = kCrowded + index into crowded
  std::vector<Eigen::Vector3d> crowded;                   ///< unit normals of edges of more than two faces

  /// Unit normal of an edge (0: ab, 1: bc, 2: ca); zero if none.
  Eigen::Vector3d edge(std::uint32_t triangle, std::size_t which) const;
  bool is_border(std::uint32_t triangle, std::size_t which) const { return neighbour[triangle][which] == kNobody; }
};

Normals surface_normals(const TriangleMesh& mesh, int threads);

}  // namespace abbe::surface
