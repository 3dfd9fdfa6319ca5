#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "abbe/geometry/surface/triangle_mesh.h"
#include "abbe/plan/scans/scan_plan.h"

namespace abbe {

/// A small part of a surface.
struct CoveredPlace {
  Eigen::Vector3d point;  ///< mm, its middle
  std::uint32_t triangle = 0;
  double area = 0;  ///< mm^2
  ScanObstacle obstacle = ScanObstacle::none;
};

/// A point on a face of the part to which a scan went, or could not go.
struct ScannedPlace {
  Eigen::Vector3d point;  ///< mm
  std::uint32_t face = 0;
  ScanObstacle obstacle = ScanObstacle::none;  ///< none: measured
};

/// Divides a mesh into triangles no longer than half the radius and says which have a point within it that was measured
/// on their own face: what was seen round an edge does not count. Others take the obstacle of the nearest point of
/// their face within twice the radius that was not measured, or `spacing` if there is none.
/// @param face_of_triangle  [triangles]
/// @param scanned           mm, frame of the mesh
/// @param triangles         those that are divided
/// @param wanted            of a point of the mesh; what is not wanted is left out
/// @param radius            mm, > 0
std::vector<CoveredPlace> covered_places(const TriangleMesh& mesh, const std::vector<std::uint32_t>& face_of_triangle,
                                         const std::vector<ScannedPlace>& scanned,
                                         const std::vector<std::uint32_t>& triangles,
                                         const std::function<bool(const Eigen::Vector3d&)>& wanted, double radius);

}  // namespace abbe
