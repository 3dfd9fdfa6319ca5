#pragma once

#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

namespace abbe {

/// What OpenCASCADE makes of a STEP file.
struct StepShape {
  TopoDS_Shape shape;  ///< mm; an assembly is a compound with its parts in their places
  double size_mm = 0;  ///< largest extent
  std::string unit;    ///< of length, as the file names it; empty if it states none
  std::vector<std::string> notes;
};

/// Reads a STEP file whole: a file with errors of syntax, a shape or a face that cannot be converted, or a coordinate
/// beyond kLargestInput is refused. @throws std::runtime_error with a sentence for the user, Standard_Failure
StepShape read_step_shape(const std::string& path);

}  // namespace abbe
