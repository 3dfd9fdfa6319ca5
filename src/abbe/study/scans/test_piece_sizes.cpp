#include "abbe/study/scans/test_piece_sizes.h"

#include <fmt/format.h>

#include <stdexcept>
#include <string>

#include "abbe/formats/shapes/curve_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

template <typename Sizes>
TestPiece made_of(const Sizes& sizes, TestPiece (*make)(const Sizes&), const char* what) {
  try {
    return make(sizes);
  } catch (const std::invalid_argument& error) {
    // What is wanted, behind the name of the piece.
    const std::string wanted = error.what();
    const std::size_t colon = wanted.find(": ");
    throw InputError({.field = what}, "these sizes make no test piece",
                     colon == std::string::npos ? wanted : wanted.substr(colon + 2));
  }
}

/// What all pieces have.
template <typename Piece>
void take_common(const TestPieceSizes& sizes, Piece& piece, Eigen::Vector3d& centre) {
  if (sizes.centre_mm.size() != 3 && !sizes.centre_mm.empty()) {
    throw InputError({.field = "--centre-mm"}, "not three numbers", "x y z in the workpiece frame, mm");
  }
  if (!sizes.centre_mm.empty()) centre = Eigen::Vector3d::Map(sizes.centre_mm.data());
  if (sizes.height_mm > 0) piece.height = sizes.height_mm;
  piece.tool_radius = sizes.tool_diameter_mm / 2;
}

std::string curve_with_sizes(const std::string& words, const TestPieceSizes& sizes, const TestPiece& piece) {
  return fmt::format("# {}\n# tool of {} mm diameter\n", words, sizes.tool_diameter_mm) + curve_csv(piece.curve);
}

}  // namespace

TestPiece test_piece_of(const ConeFrustum& frustum) { return made_of(frustum, cone_frustum, "cone frustum"); }
TestPiece test_piece_of(const SShape& shape) { return made_of(shape, s_shape, "S shape"); }

ConeFrustum cone_frustum_of(const TestPieceSizes& sizes) {
  ConeFrustum frustum;
  take_common(sizes, frustum, frustum.base_centre);
  frustum.base_diameter = sizes.base_diameter_mm;
  frustum.half_apex_angle = sizes.half_apex_deg * kDegree;
  frustum.inclination = sizes.inclination_deg * kDegree;
  frustum.lean_azimuth = sizes.azimuth_deg * kDegree;
  return frustum;
}

SShape s_shape_of(const TestPieceSizes& sizes) {
  SShape shape;
  take_common(sizes, shape, shape.centre);
  shape.length = sizes.length_mm;
  shape.amplitude = sizes.amplitude_mm;
  shape.lean = sizes.lean_deg * kDegree;
  shape.twist = sizes.twist_deg * kDegree;
  shape.azimuth = sizes.azimuth_deg * kDegree;
  return shape;
}

std::string cone_frustum_csv(const TestPieceSizes& sizes, const TestPiece& piece) {
  return curve_with_sizes(fmt::format("cone frustum: base {} mm, half apex angle {} deg, inclination {} deg",
                                      sizes.base_diameter_mm, sizes.half_apex_deg, sizes.inclination_deg),
                          sizes, piece);
}

std::string s_shape_csv(const TestPieceSizes& sizes, const TestPiece& piece) {
  return curve_with_sizes(fmt::format("S shape: length {} mm, amplitude {} mm, lean {} deg, twist {} deg",
                                      sizes.length_mm, sizes.amplitude_mm, sizes.lean_deg, sizes.twist_deg),
                          sizes, piece);
}

}  // namespace abbe
