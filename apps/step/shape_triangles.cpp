#include "shape_triangles.h"

#include <fmt/format.h>

#include <BRep_Tool.hxx>
#include <Eigen/Core>
#include <Poly_Triangulation.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "abbe/formats/list_text.h"
#include "abbe/geometry/mesh_check.h"
#include "abbe/geometry/vertex_welder.h"
#include "face_deviation.h"

namespace abbe {
namespace {

/// Triangles of the faces of one solid or shell, with their own vertices.
struct Piece {
  std::vector<double> corners;       // 9 per triangle
  std::vector<std::uint32_t> faces;  // 1 per triangle
};

void add_face(const TopoDS_Face& face, std::uint32_t number, Piece& piece) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
  // A face without area has none.
  if (triangulation.IsNull()) return;
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

/// Says which faces are missing, or refuses them.
void account_for_lost(const StepShape& read, const std::vector<LostFace>& lost, bool leave_out, StepMesh& result) {
  result.left_out = read.left_out;
  for (const LostFace& one : lost) result.left_out.push_back(read.face_name(one.face) + " " + one.problem);
  if (!result.left_out.empty() && !leave_out) refuse_faces(result.left_out);
}

std::string deviation_note(const StepShape& read, const ShapeDivision::Off& off, double chord_mm) {
  return fmt::format("face {} is up to {:.3g} mm off its triangles instead of {:.3g} mm{}", read.face_name(off.face),
                     off.deviation_mm, chord_mm,
                     off.gap_mm > 0.1 * chord_mm
                         ? fmt::format(": the file's own edges lie up to {:.3g} mm beside it", off.gap_mm)
                         : "");
}

}  // namespace

StepMesh shape_triangles(const StepShape& read, const ShapeTrianglesOptions& options) {
  const double chord = options.division.chord_mm;
  const ShapeDivision division = divide_shape(read.shape, options.division);
  StepMesh result;
  account_for_lost(read, division.lost, options.leave_out_faces, result);
  const double deviation = division.farthest.deviation_mm;
  // Only edges that lie beside their faces excuse a larger deviation.
  const bool is_in_excess = division.excess_mm > chord;
  if (is_in_excess || deviation > options.most_mm) {
    throw StepRefused(deviation_note(read, is_in_excess ? division.most_in_excess : division.farthest, chord),
                      fmt::format("a chord tolerance of at least {:.3g} mm (--chord-mm)", 1.01 * deviation));
  }
  if (deviation > chord) result.notes.push_back(deviation_note(read, division.farthest, chord));
  if (division.without_area > 0) {
    result.notes.push_back(counted(division.without_area, "face has no area", "faces have no area"));
  }
  result.deviation_mm = deviation;
  std::set<const void*> lost;
  for (const LostFace& face : division.lost) lost.insert(face.face.TShape().get());
  Growing growing;
  std::uint32_t faces = 0;
  double lost_area = 0;
  const auto add_faces_of = [&](const TopoDS_Shape& whole, TopAbs_ShapeEnum but_not_in) {
    Piece piece;
    for (TopExp_Explorer face(whole, TopAbs_FACE, but_not_in); face.More(); face.Next()) {
      const TopoDS_Face& one = TopoDS::Face(face.Current());
      if (lost.count(one.TShape().get()) > 0) {
        lost_area += face_area_mm2(one);
      } else {
        add_face(one, faces, piece);
      }
      ++faces;
    }
    growing.add(piece);
  };
  for (TopExp_Explorer solid(read.shape, TopAbs_SOLID); solid.More(); solid.Next(), ++result.solids) {
    add_faces_of(solid.Current(), TopAbs_SHAPE);
  }
  for (TopExp_Explorer shell(read.shape, TopAbs_SHELL, TopAbs_SOLID); shell.More(); shell.Next()) {
    add_faces_of(shell.Current(), TopAbs_SHAPE);
  }
  add_faces_of(read.shape, TopAbs_SHELL);
  if (growing.triangles.empty()) {
    throw std::runtime_error(faces == 0 ? "there are no faces in the file"
                             : result.left_out.empty()
                                 ? "no face of the file has an area"
                                 : "no face of the file could be divided: " + first_few(result.left_out, "; "));
  }
  result.faces = faces;
  result.mesh.vertices = growing.welder.vertices();
  result.mesh.triangles = Eigen::Map<const Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic>>(
      growing.triangles.data(), 3, static_cast<Eigen::Index>(growing.triangles.size() / 3));
  result.face_of_triangle = std::move(growing.faces);
  // Nothing is known about the area of a face that OpenCASCADE could not make.
  if (!result.left_out.empty() && read.left_out.empty() && std::isfinite(lost_area)) {
    result.left_out_share = lost_area / (lost_area + check_mesh(result.mesh).area);
  }
  return result;
}

}  // namespace abbe
