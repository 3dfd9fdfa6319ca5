#pragma once

#include <Eigen/Core>

#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// A laser has taken material away along a line: what a cut across that line shows.
///
/// In the section: u across the line, v out of the material. The surface, the wall along the beam, a rounding between
/// them that touches both, the bottom; and for a groove the same again on the other side, mirrored at its middle.
/// `corner` is where surface and wall would meet without the rounding.
struct EngravedEdge {
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();  ///< mm
  double radius = 0.015;                             ///< mm, of the rounding
  double depth = 0.1;                                ///< mm, below the corner
  double beam_tilt = 0;                              ///< rad, of the wall from v towards u
  double groove_width = 0;                           ///< mm between the two corners; 0: an edge, no other side
  double surface_curvature = 0;                      ///< 1/mm, of the surface about u = 0; positive: convex
};

/// Points of the section from left to right, [2, n] mm. @param half_width  how far the surface reaches to either side
Eigen::Matrix2Xd engraved_profile(const EngravedEdge& edge, double half_width);

/// The section drawn out along the line: a sheet of triangles, facing outwards; x = u, z = v, y along the line, mm.
TriangleMesh engraved_mesh(const EngravedEdge& edge, double half_width, double half_length);

}  // namespace abbe
