#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "abbe/geometry/surface/closest_point.h"
#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// The curved surface for which the triangles of a mesh stand.
///
/// Every corner of a triangle has the mean normal of the triangles around it that are not beyond a crease; inside, the
/// normal is interpolated, and the change of the normals gives the curvature. A cylinder of 72 flat strips so becomes
/// the cylinder that it stands for. Source: Rusinkiewicz, 3D Data Processing (2004) 486 (curvature from normals).
class SmoothSurface {
 public:
  /// @param crease_angle  triangles that meet at a larger angle meet at an edge of the part, rad
  explicit SmoothSurface(const TriangleMesh& mesh, double crease_angle = 0.52, int threads = 0);

  /// Unit normal at a point of a triangle.
  Eigen::Vector3d normal(std::uint32_t triangle, const Eigen::Vector3d& point) const;

  /// How the normal turns with the place, in the plane of the triangle: positive where the surface is convex.
  struct Curvature {
    Eigen::Vector3d direction[2];  ///< unit vectors in the plane of the triangle
    double value[2] = {0, 0};      ///< 1/mm
  };
  Curvature curvature(std::uint32_t triangle) const;

 private:
  struct Face {
    Eigen::Vector3d corner, ab, ac;
    std::array<Eigen::Vector3f, 3> normal;
  };
  std::vector<Face> faces_;
};

}  // namespace abbe
