#include "shape_triangles.h"

#include <fmt/format.h>

#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <cmath>
#include <set>
#include <stdexcept>

#include "abbe/formats/text/list_text.h"
#include "abbe/geometry/surface/mesh_check.h"
#include "face_deviation.h"
#include "face_mesh.h"

namespace abbe {
namespace {

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
  FaceMesh mesh;
  std::uint32_t faces = 0;
  double lost_area = 0;
  const auto add_faces_of = [&](const TopoDS_Shape& whole, TopAbs_ShapeEnum but_not_in) {
    FacePiece piece;
    for (TopExp_Explorer face(whole, TopAbs_FACE, but_not_in); face.More(); face.Next()) {
      const TopoDS_Face& one = TopoDS::Face(face.Current());
      if (lost.count(one.TShape().get()) > 0) {
        lost_area += face_area_mm2(one);
      } else {
        piece.add(one, faces);
      }
      ++faces;
    }
    mesh.add(piece);
  };
  for (TopExp_Explorer solid(read.shape, TopAbs_SOLID); solid.More(); solid.Next(), ++result.solids) {
    add_faces_of(solid.Current(), TopAbs_SHAPE);
  }
  for (TopExp_Explorer shell(read.shape, TopAbs_SHELL, TopAbs_SOLID); shell.More(); shell.Next()) {
    add_faces_of(shell.Current(), TopAbs_SHAPE);
  }
  add_faces_of(read.shape, TopAbs_SHELL);
  if (mesh.empty()) {
    throw std::runtime_error(faces == 0 ? "there are no faces in the file"
                             : result.left_out.empty()
                                 ? "no face of the file has an area"
                                 : "no face of the file could be divided: " + first_few(result.left_out, "; "));
  }
  result.faces = faces;
  result.mesh = mesh.mesh();
  result.face_of_triangle = mesh.face_of_triangle();
  // Nothing is known about the area of a face that OpenCASCADE could not make.
  if (!result.left_out.empty() && read.left_out.empty() && std::isfinite(lost_area)) {
    result.left_out_share = lost_area / (lost_area + check_mesh(result.mesh).area);
  }
  return result;
}

}  // namespace abbe
