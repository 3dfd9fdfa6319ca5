#pragma once

// For formats and the program abbe-step: how the one hands its triangles to the other.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// Exit code of abbe-step when its time is up. It then gives no message.
constexpr int kStepTimeIsUp = 3;

/// Faces of a STEP file as triangles.
struct StepMesh {
  TriangleMesh mesh;                            ///< mm
  std::vector<std::uint32_t> face_of_triangle;  ///< [triangles] number of the face, from 0 in the order of the file
  std::size_t faces = 0;
  std::size_t solids = 0;
  std::string unit;         ///< of length, as the file names it; empty if it states none
  double deviation_mm = 0;  ///< 1.03 times the largest distance found between triangles and faces, edges included
  double chord_mm = 0;      ///< deviation that was aimed at
  double size_mm = 0;       ///< largest extent of the shape
  std::vector<std::string> left_out;     ///< faces: "#78 (cone about (0, 0, 5) mm) could not be divided ..."
  std::optional<double> left_out_share;  ///< of the area, where that is known
  std::vector<std::string> notes;        ///< sentences for the user
};

/// Smallest deviation that may be asked for, as a fraction of the size. A smaller one would need thousands of millions
/// of triangles, and only a damaged file or a mistyped tolerance asks for it.
constexpr double kFinestStepChord = 1e-7;

/// The deviation aimed at where the user states none: 0.01 mm; under 10 mm a thousandth of the size, over 100 mm a
/// ten-thousandth, at most 0.1 mm or, above 1 km, kFinestStepChord.
double default_step_chord(double size_mm);

/// What abbe-step is doing.
struct StepProgress {
  std::string what;  ///< "dividing faces"
  std::size_t done = 0, total = 0;
};

/// As a line on the standard error of abbe-step, without its end, and back; nothing for any other line.
std::string step_progress_line(const StepProgress& progress);
std::optional<StepProgress> parse_step_progress(std::string_view line);

/// A line of JSON with what can be counted, then the arrays as this processor keeps them: for another program on the
/// same computer, in memory, not for a disk.
std::string step_mesh_bytes(const StepMesh& mesh);

/// @param file  name for messages
/// @throws InputError if the bytes are not what step_mesh_bytes() gives: cut off, an index out of range, a coordinate
/// that is not finite or larger than kLargestInput
StepMesh parse_step_mesh(std::string_view bytes, const std::string& file);

}  // namespace abbe
