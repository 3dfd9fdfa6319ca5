#pragma once

#include <cstdint>

#include "abbe/geometry/surface/point_cloud.h"
#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// Points spread evenly over the area of a surface, with the normals of their faces; in the order of the triangles.
///
/// One random point in each of `count` parts of equal area. The same seed gives the same points.
PointCloud sample_surface(const TriangleMesh& mesh, Eigen::Index count, std::uint64_t seed);

/// A thinner cloud with unit normals, for the search of a start.
struct ThinnedScan {
  Eigen::Matrix3Xd points, normals;  ///< [3, n] mm; unit vectors
  Eigen::Matrix3Xd places;           ///< [3, m] mm: one point of each cell, also of those without a normal
  bool outwards = false;             ///< the normals are those of the cloud; else their signs mean nothing
};

/// One point per cell of the given size, each with the normal of the plane through the points around it.
///
/// Points whose surroundings are no surface (edges, stray points, points far from all others) have no normal.
/// @param cell  mm
ThinnedScan thin_scan(const PointCloud& cloud, double cell);

}  // namespace abbe
