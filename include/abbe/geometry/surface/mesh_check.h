#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// What can be said of a mesh by counting; see docs/geometry-files.md.
///
/// Edges are compared by their vertices, so a mesh whose triangles do not share vertices is open everywhere (readers of
/// files without shared vertices weld them). Whether the surface passes through itself is not looked at.
struct MeshCheck {
  std::size_t triangles = 0;
  std::size_t vertices = 0;
  std::size_t unused_vertices = 0;       ///< in no triangle
  std::size_t degenerate_triangles = 0;  ///< no higher than what a double resolves at their place
  std::size_t duplicate_triangles = 0;   ///< beyond the first with the same three vertices, whatever the sense
  std::size_t edges = 0;                 ///< different ones
  std::size_t border_edges = 0;          ///< of one triangle
  std::size_t rims = 0;             ///< lines of border edges that hang together: holes, or the outline of an open part
  std::size_t branching_edges = 0;  ///< of more than two triangles
  std::size_t turned_edges = 0;     ///< of two triangles that run along it the same way: one is turned over
  std::size_t parts = 0;            ///< pieces that share no vertex

  double area = 0;  ///< mm^2
  /// mm^3 inside, positive if the triangles count anticlockwise from outside; 0 unless encloses_volume().
  double volume = 0;
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();  ///< mm, of the vertices in use
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();

  /// Every edge belongs to two triangles.
  bool is_closed() const { return triangles > 0 && border_edges == 0 && branching_edges == 0; }
  /// No two neighbours are turned against each other.
  bool is_oriented() const { return turned_edges == 0; }
  bool encloses_volume() const { return is_closed() && is_oriented(); }
};

/// Time and memory with the number of triangles (and the logarithm of the most at one vertex).
MeshCheck check_mesh(const TriangleMesh& mesh);

}  // namespace abbe
