#pragma once

// Internal to formats and to the program abbe-step: how the one hands its triangles to the other.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/geometry/triangle_mesh.h"

namespace abbe {

/// Faces of a STEP file as triangles.
struct StepMesh {
  TriangleMesh mesh;                            ///< mm
  std::vector<std::uint32_t> face_of_triangle;  ///< [triangles] number of the face, from 0 in the order of the file
  std::size_t faces = 0;
  std::size_t solids = 0;
  std::string unit;          ///< of length, as the file names it; empty if it states none
  double deviation_mm = 0;   ///< largest distance of triangles and faces, edges included: 1.03 times what was measured
  double deflection_mm = 0;  ///< what the mesher was asked for to get there
  std::vector<std::string> notes;  ///< sentences for the user
};

/// A line of JSON with what can be counted, then the arrays as this processor keeps them: for another program on the
/// same computer, in memory, not for a disk.
std::string step_mesh_bytes(const StepMesh& mesh);

/// @param file  name for messages
/// @throws InputError if the bytes are not what step_mesh_bytes() gives: cut off, an index out of range, a coordinate
/// that is not finite or larger than kLargestInput
StepMesh parse_step_mesh(std::string_view bytes, const std::string& file);

}  // namespace abbe
