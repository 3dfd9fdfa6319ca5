#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "abbe/geometry/surface/smooth_surface.h"
#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// Points along a line in which a plane meets a surface.
struct SurfaceLine {
  Eigen::Matrix3Xd points;   ///< [3, n] mm, even along the line where it is hardly bent, half a step away from its ends
  Eigen::Matrix3Xd normals;  ///< [3, n] unit, of the smooth surface
  bool is_closed = false;    ///< the last point is followed by the first
  double height = 0;         ///< mm, of the plane along its normal
};

/// Lines in which parallel planes meet some triangles of a mesh, lowest plane first.
///
/// Planes are as far apart as needed for lines not farther apart on the surface than `between`, but at most 20 times
/// closer where the surface is nearly parallel to them. The vertices of the mesh must be shared between its triangles.
/// @param triangles  the triangles of one face
/// @param direction  unit normal of the planes
/// @param along, between  mm, > 0: distance of points along a line and of lines on the surface
/// @param largest_turn    rad, > 0: of the normal from point to point; where it turns faster, points are closer
std::vector<SurfaceLine> surface_lines(const TriangleMesh& mesh, const SmoothSurface& smooth,
                                       std::span<const std::uint32_t> triangles, const Eigen::Vector3d& direction,
                                       double along, double between,
                                       double largest_turn = std::numeric_limits<double>::infinity());

/// The same, one line after the other: only one of them is kept in memory.
void for_each_surface_line(const TriangleMesh& mesh, const SmoothSurface& smooth,
                           std::span<const std::uint32_t> triangles, const Eigen::Vector3d& direction, double along,
                           double between, double largest_turn, const std::function<void(const SurfaceLine&)>& visit);

}  // namespace abbe
