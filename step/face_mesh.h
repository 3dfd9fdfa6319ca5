#pragma once

#include <TopoDS_Face.hxx>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "abbe/geometry/surface/triangle_mesh.h"
#include "abbe/geometry/surface/vertex_welder.h"

namespace abbe {

/// Triangles of the faces of one solid or shell, with their own vertices.
struct FacePiece {
  std::vector<double> corners;       ///< in mm, 9 per triangle
  std::vector<std::uint32_t> faces;  ///< number of the face, 1 per triangle

  /// Adds the triangles that OpenCASCADE keeps in a face; a face without area has none.
  void add(const TopoDS_Face& face, std::uint32_t number);
};

/// One mesh of several solids or shells, whose faces share the vertices along their common edges.
class FaceMesh {
 public:
  /// A piece that closes but counts its triangles clockwise from outside is turned over.
  void add(const FacePiece& piece);

  bool empty() const { return triangles_.empty(); }
  TriangleMesh mesh() const;
  const std::vector<std::uint32_t>& face_of_triangle() const { return faces_; }

 private:
  VertexWelder welder_{1000};
  std::vector<std::uint32_t> triangles_;  ///< 3 corners per triangle
  std::vector<std::uint32_t> faces_;
};

}  // namespace abbe
