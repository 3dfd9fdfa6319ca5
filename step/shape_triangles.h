#pragma once

#include "abbe/formats/shapes/step_mesh.h"
#include "shape_division.h"
#include "step_shape.h"

namespace abbe {

struct ShapeTrianglesOptions {
  DivisionOptions division;
  /// Where the file's own edges lie beside its faces the chord cannot be kept: a face up to this far from its triangles
  /// is taken, with a note; one farther away refuses the file.
  double most_mm = 0;
  bool leave_out_faces = false;  ///< those without triangles; else they refuse the file
};

/// The faces of a shape as triangles (divide_shape()): of its solids, then of shells and faces that are in no solid.
///
/// Sides that faces share are shared by their triangles; those of a closed solid count anticlockwise from outside.
/// @throws std::runtime_error with a sentence for the user, StepRefused, TimeIsUp, Standard_Failure
StepMesh shape_triangles(const StepShape& read, const ShapeTrianglesOptions& options);

}  // namespace abbe
