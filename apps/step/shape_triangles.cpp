#include "shape_triangles.h"

#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Eigen/Core>
#include <IMeshTools_Parameters.hxx>
#include <Poly_Triangulation.hxx>
#include <ShapeAnalysis_ShapeTolerance.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "abbe/geometry/mesh_check.h"
#include "abbe/geometry/vertex_welder.h"
#include "face_deviation.h"

namespace abbe {
namespace {

void divide(const TopoDS_Shape& shape, double deflection_mm, double angle_rad) {
  BRepTools::Clean(shape);
  IMeshTools_Parameters parameters;
  parameters.Deflection = deflection_mm;
  parameters.DeflectionInterior = deflection_mm;
  parameters.Angle = angle_rad;
  parameters.AngleInterior = angle_rad;
  parameters.Relative = Standard_False;
#ifndef ABBE_SANITIZED
  // Faces one by one give the same triangles; the thread sanitizer does not see OpenCASCADE's locks.
  parameters.InParallel = Standard_True;
#endif
  const BRepMesh_IncrementalMesh mesher(shape, parameters);
}

double shape_deviation(const TopoDS_Shape& shape) {
  double largest = 0;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    largest = face_deviation(TopoDS::Face(face.Current()), largest);
  }
  return largest;
}

/// The farthest point of a triangle may be between those that face_deviation() looks at.
constexpr double kBetweenPoints = 1.03;

/// Divides until the deviation is small enough. @returns deviation, deflection
std::pair<double, double> divide_within(const TopoDS_Shape& shape, double chord_mm, double angle_rad) {
  double deflection = chord_mm, best = 0;
  // The deviation follows the deflection where that decides; three rounds are the rule. Below a fiftieth it does not:
  // then the file's edges do not lie on its faces.
  for (int round = 0; round < 12 && deflection > chord_mm / 50; ++round) {
    divide(shape, deflection, angle_rad);
    const double deviation = kBetweenPoints * shape_deviation(shape);
    if (deviation <= chord_mm) return {deviation, deflection};
    best = round == 0 ? deviation : std::min(best, deviation);
    deflection *= std::clamp(0.95 * chord_mm / deviation, 0.3, 0.9);
  }
  throw ToleranceNotReached{best, ShapeAnalysis_ShapeTolerance().Tolerance(shape, 1)};
}

/// Triangles of the faces of one solid or shell, with their own vertices.
struct Piece {
  std::vector<double> corners;       // 9 per triangle
  std::vector<std::uint32_t> faces;  // 1 per triangle
};

void add_face(const TopoDS_Face& face, std::uint32_t number, Piece& piece) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
  const gp_Trsf part_from_face = location.Transformation();
  for (int i = 1; i <= triangulation->NbTriangles(); ++i) {
    int nodes[3] = {0, 0, 0};
    triangulation->Triangle(i).Get(nodes[0], nodes[1], nodes[2]);
    if ((face.Orientation() == TopAbs_REVERSED) != part_from_face.IsNegative()) std::swap(nodes[1], nodes[2]);
    for (const int node : nodes) {
      const gp_Pnt point = triangulation->Node(node).Transformed(part_from_face);
      piece.corners.insert(piece.corners.end(), {point.X(), point.Y(), point.Z()});
    }
    piece.faces.push_back(number);
  }
}

/// True if the triangles of a piece close and count clockwise from outside.
bool is_inside_out(const Piece& piece) {
  std::vector<std::uint32_t> indices(piece.corners.size() / 3);
  VertexWelder welder(indices.size() / 6 + 1);
  welder.add(piece.corners, indices.data());
  TriangleMesh mesh;
  mesh.vertices = welder.vertices();
  mesh.triangles = Eigen::Map<const Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic>>(
      indices.data(), 3, static_cast<Eigen::Index>(indices.size() / 3));
  const MeshCheck check = check_mesh(mesh);
  return check.encloses_volume() && check.volume < 0;
}

/// The whole mesh while pieces come.
struct Growing {
  VertexWelder welder{1000};
  std::vector<std::uint32_t> triangles;
  std::vector<std::uint32_t> faces;

  void add(const Piece& piece) {
    if (piece.faces.empty()) return;
    const bool turn = is_inside_out(piece);
    // Edges that two faces share have the same nodes in both, so that equal coordinates are all that is needed.
    std::vector<std::uint32_t> indices(piece.corners.size() / 3);
    welder.add(piece.corners, indices.data());
    for (std::size_t i = 0; i < piece.faces.size(); ++i) {
      const std::uint32_t a = indices[3 * i], b = indices[3 * i + 1], c = indices[3 * i + 2];
      // At the apex of a cone two corners are one point.
      if (a == b || b == c || c == a) continue;
      triangles.insert(triangles.end(), {a, turn ? c : b, turn ? b : c});
      faces.push_back(piece.faces[i]);
    }
  }
};

}  // namespace

StepMesh shape_triangles(const TopoDS_Shape& shape, double chord_mm, double angle_rad) {
  StepMesh result;
  std::tie(result.deviation_mm, result.deflection_mm) = divide_within(shape, chord_mm, angle_rad);
  Growing growing;
  std::uint32_t faces = 0;
  const auto add_faces_of = [&](const TopoDS_Shape& whole, TopAbs_ShapeEnum but_not_in) {
    Piece piece;
    for (TopExp_Explorer face(whole, TopAbs_FACE, but_not_in); face.More(); face.Next()) {
      add_face(TopoDS::Face(face.Current()), faces++, piece);
    }
    growing.add(piece);
  };
  for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next(), ++result.solids) {
    add_faces_of(solid.Current(), TopAbs_SHAPE);
  }
  for (TopExp_Explorer shell(shape, TopAbs_SHELL, TopAbs_SOLID); shell.More(); shell.Next()) {
    add_faces_of(shell.Current(), TopAbs_SHAPE);
  }
  add_faces_of(shape, TopAbs_SHELL);
  if (growing.triangles.empty()) throw std::runtime_error("there are no faces in the file");
  result.faces = faces;
  result.mesh.vertices = growing.welder.vertices();
  result.mesh.triangles = Eigen::Map<const Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic>>(
      growing.triangles.data(), 3, static_cast<Eigen::Index>(growing.triangles.size() / 3));
  result.face_of_triangle = std::move(growing.faces);
  return result;
}

}  // namespace abbe
