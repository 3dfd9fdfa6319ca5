#include "face_mesh.h"

#include <BRep_Tool.hxx>
#include <Eigen/Core>
#include <Poly_Triangulation.hxx>
#include <TopLoc_Location.hxx>
#include <gp_Pnt.hxx>
#include <gp_Trsf.hxx>
#include <utility>

#include "abbe/geometry/surface/mesh_check.h"

namespace abbe {
namespace {

TriangleMesh mesh_of(const VertexWelder& welder, const std::vector<std::uint32_t>& triangles) {
  TriangleMesh mesh;
  mesh.vertices = welder.vertices();
  mesh.triangles = Eigen::Map<const Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic>>(
      triangles.data(), 3, static_cast<Eigen::Index>(triangles.size() / 3));
  return mesh;
}

/// True if the triangles of a piece close and count clockwise from outside.
bool is_inside_out(const FacePiece& piece) {
  std::vector<std::uint32_t> indices(piece.corners.size() / 3);
  VertexWelder welder(indices.size() / 6 + 1);
  welder.add(piece.corners, indices.data());
  const MeshCheck check = check_mesh(mesh_of(welder, indices));
  return check.encloses_volume() && check.volume < 0;
}

}  // namespace

void FacePiece::add(const TopoDS_Face& face, std::uint32_t number) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
  if (triangulation.IsNull()) return;
  const gp_Trsf part_from_face = location.Transformation();
  for (int i = 1; i <= triangulation->NbTriangles(); ++i) {
    int nodes[3] = {0, 0, 0};
    triangulation->Triangle(i).Get(nodes[0], nodes[1], nodes[2]);
    if ((face.Orientation() == TopAbs_REVERSED) != part_from_face.IsNegative()) std::swap(nodes[1], nodes[2]);
    for (const int node : nodes) {
      const gp_Pnt point = triangulation->Node(node).Transformed(part_from_face);
      corners.insert(corners.end(), {point.X(), point.Y(), point.Z()});
    }
    faces.push_back(number);
  }
}

void FaceMesh::add(const FacePiece& piece) {
  if (piece.faces.empty()) return;
  const bool turn = is_inside_out(piece);
  // Edges that two faces share have the same nodes in both, so that equal coordinates are all that is needed.
  std::vector<std::uint32_t> indices(piece.corners.size() / 3);
  welder_.add(piece.corners, indices.data());
  for (std::size_t i = 0; i < piece.faces.size(); ++i) {
    const std::uint32_t a = indices[3 * i], b = indices[3 * i + 1], c = indices[3 * i + 2];
    // At the apex of a cone two corners are one point.
    if (a == b || b == c || c == a) continue;
    triangles_.insert(triangles_.end(), {a, turn ? c : b, turn ? b : c});
    faces_.push_back(piece.faces[i]);
  }
}

TriangleMesh FaceMesh::mesh() const { return mesh_of(welder_, triangles_); }

}  // namespace abbe
