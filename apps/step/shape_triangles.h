#pragma once

#include <TopoDS_Shape.hxx>

#include "abbe/formats/step_mesh.h"

namespace abbe {

/// The faces of a shape as triangles: of its solids, then of shells and faces that are in no solid.
///
/// The mesher is asked for a smaller deflection until the distance measured by face_deviation() is at most chord_mm,
/// which it does not keep by itself. Sides that faces share are shared by their triangles; those of a closed solid
/// count anticlockwise from outside.
/// @throws std::runtime_error with a sentence for the user, ToleranceNotReached, Standard_Failure
StepMesh shape_triangles(const TopoDS_Shape& shape, double chord_mm, double angle_rad);

/// No triangles were found that come near enough to the faces.
struct ToleranceNotReached {
  double nearest_mm = 0;   ///< smallest deviation that was reached
  double file_gap_mm = 0;  ///< how far the file's own edges and vertices may be from its faces, as it says
};

}  // namespace abbe
