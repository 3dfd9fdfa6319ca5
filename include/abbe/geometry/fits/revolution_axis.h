#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// A line about which a surface may turn into itself.
struct RevolutionAxis {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< mm, on the line, near the surface
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit
};

/// Lines about which a part of a mesh may have been turned, likeliest first: every surface has some, so
/// revolution_deviation() decides.
///
/// A motion p -> c x p + c' keeps a surface where it is if c . (p x n) + c' . n vanishes at all of its points p with
/// normals n. The candidates are the rotations among the motions for which the mean square of this is smallest: one
/// for a surface of revolution, two (a rotation and a shift) for a cylinder, three for a sphere.
/// @param triangles   of the mesh, at least one with area
/// @param directions  unit vectors that are tried through the centre of a sphere, whose axis is free
/// Source: Pottmann, Randrup, Computing 60 (1998) 307: rotational and helical surface approximation; Gelfand, Guibas,
/// Eurographics Symposium on Geometry Processing 2004, 214.
std::vector<RevolutionAxis> revolution_axes(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                                            std::span<const Eigen::Vector3d> directions);

/// How far a part of a mesh is from a surface of revolution about a line, mm: the largest product of the distance of a
/// normal from the line and the sine of their angle.
///
/// A triangle stands for a piece of the surface, whose normals pass it somewhere: only what its normal misses the line
/// by from every place of the triangle counts. A strip of a cylinder misses nothing.
double revolution_deviation(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                            const RevolutionAxis& axis);

}  // namespace abbe
