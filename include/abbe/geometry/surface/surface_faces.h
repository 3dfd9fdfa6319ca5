#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// Faces of a part: parts of its surface that are connected without an edge.
struct SurfaceFaces {
  std::vector<std::uint32_t> face_of_triangle;  ///< [triangles] numbered in the order of their first triangles
  std::vector<double> area;                     ///< [faces] mm^2
  std::vector<Eigen::Vector3d> middle;          ///< [faces] centre of area, mm

  std::size_t count() const { return area.size(); }
};

/// @param crease_angle  triangles that meet at a larger angle belong to different faces, rad
SurfaceFaces surface_faces(const TriangleMesh& mesh, double crease_angle, int threads = 0);

/// Faces as a file states them, whether connected or not.
/// @param face_of_triangle  [triangles] below `faces`
SurfaceFaces stated_faces(const TriangleMesh& mesh, const std::vector<std::uint32_t>& face_of_triangle,
                          std::size_t faces);

}  // namespace abbe
