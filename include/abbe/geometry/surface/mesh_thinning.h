#pragma once

#include <Eigen/Core>

#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// A mesh of fewer triangles, for pictures.
struct ThinnedMesh {
  TriangleMesh mesh;
  double cell_mm = 0;  ///< edge of the cubes in which all vertices became one; 0: the mesh is as it was
};

/// At most so many triangles: all vertices within a cube of a grid become one, which lies where the planes of their
/// triangles meet best, so that edges and corners stay sharp; the grid is as fine as the number allows.
///
/// No vertex moves by more than one and a half diagonals of a cube. Details smaller than a cube are lost, and walls
/// thinner than it may become sheets: nothing is measured on such a mesh.
/// @param most_triangles  at least 100
/// Sources: J. Rossignac, P. Borrel: Multi-resolution 3D approximations, in Modeling in Computer Graphics (1993) 455;
/// P. Lindstrom: Out-of-core simplification of large polygonal models, SIGGRAPH (2000) 259.
ThinnedMesh thinned_mesh(const TriangleMesh& mesh, Eigen::Index most_triangles);

}  // namespace abbe
