#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "abbe/geometry/triangle_mesh.h"

namespace abbe {

/// A small part of a surface.
struct CoveredPlace {
  Eigen::Vector3d point;  ///< mm, its middle
  std::uint32_t triangle = 0;
  double area = 0;  ///< mm^2
  bool covered = false;
};

/// A measured point on a face of the part.
struct MeasuredPlace {
  Eigen::Vector3d point;  ///< mm
  std::uint32_t face = 0;
};

/// Divides a mesh into triangles no longer than half the radius and says which have a point within it that was measured
/// on their own face: what was seen round an edge does not count.
/// @param face_of_triangle  [triangles]
/// @param measured          mm, frame of the mesh
/// @param radius            mm, > 0
std::vector<CoveredPlace> covered_places(const TriangleMesh& mesh, const std::vector<std::uint32_t>& face_of_triangle,
                                         const std::vector<MeasuredPlace>& measured, double radius);

}  // namespace abbe
