#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "time_limit.h"

namespace abbe {

/// What OpenCASCADE makes of a STEP file.
struct StepShape {
  TopoDS_Shape shape;  ///< mm; an assembly is a compound with its parts in their places
  double size_mm = 0;  ///< largest extent
  std::string unit;    ///< of length, as the file names it; empty if it states none
  std::vector<std::string> notes;
  std::map<const void*, std::string> face_labels;  ///< "#17", by TShape
  std::vector<std::string> left_out;               ///< faces that are not in the shape, with the reason

  /// "#17 (cone about (-16.4, 0, 27.5) mm)": the face as the file numbers it, its surface, the middle of its box.
  std::string face_name(const TopoDS_Face& face) const;
};

/// A file that is refused, with what was expected.
struct StepRefused : std::runtime_error {
  StepRefused(const std::string& problem, std::string expected_instead)
      : std::runtime_error(problem), expected(std::move(expected_instead)) {}
  std::string expected;
};

/// Refuses faces that cannot be read, with their names. @throws StepRefused
[[noreturn]] void refuse_faces(const std::vector<std::string>& faces);

/// Reads a STEP file whole: one with errors of syntax, without a shape, with a face that cannot be converted, with an
/// entity of shape, place or size that cannot be understood or with a coordinate beyond kLargestInput is refused.
/// Products without a shape, and entities of parameter-space curves (pcurves), of unused faces or of anything that is
/// not geometry, are only noted.
/// @param leave_out_faces  faces that cannot be converted or understood are left out instead
/// @throws std::runtime_error with a sentence for the user, StepRefused, TimeIsUp, Standard_Failure
StepShape read_step_shape(const std::string& path, bool leave_out_faces, const Handle(TimeLimit) & limit);

}  // namespace abbe
