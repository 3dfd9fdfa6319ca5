#pragma once

#include <Eigen/Core>

#include "abbe/geometry/surface/surface_faces.h"
#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// A mesh whose edges are all at most so long, by halving longer ones; the same surface, neighbours keep sharing edges.
struct RefinedMesh {
  TriangleMesh mesh;
  double longest_mm = 0;  ///< edges are no longer: the length asked for, or what `most_triangles` allowed
};

/// @param longest_mm      above zero
/// @param most_triangles  if it takes more, the length grows until these are enough; a mesh that has more already stays
RefinedMesh refined_mesh(const TriangleMesh& mesh, double longest_mm, Eigen::Index most_triangles);

/// The same triangles with vertices of their own for each face, so that values and normals end at the edges of a part.
/// @param faces  of this mesh
TriangleMesh with_separate_faces(const TriangleMesh& mesh, const SurfaceFaces& faces);

/// Mean normals of the triangles at each vertex, weighted with their areas. @return [3, vertices] unit, or zero
Eigen::Matrix3Xd vertex_normals(const TriangleMesh& mesh);

}  // namespace abbe
