#pragma once

#include <string>
#include <vector>

#include "abbe/machine/test_piece.h"

namespace abbe {

/// Test pieces of sizes that a user gave: cone_frustum() and s_shape(), whose refusals become messages.
/// @throws InputError for sizes that make no test piece
TestPiece test_piece_of(const ConeFrustum& frustum);
TestPiece test_piece_of(const SShape& shape);

/// Sizes of a test piece as people give them, each with its unit; a piece takes those that it has.
///
/// Messages name a field by the option of `abbe test-piece` that sets it.
struct TestPieceSizes {
  std::vector<double> centre_mm;  ///< --centre-mm, three numbers; empty: the piece's default
  double tool_diameter_mm = 20;
  double height_mm = 0;  ///< 0: the piece's default
  double azimuth_deg = 0;
  double base_diameter_mm = 80, half_apex_deg = 15, inclination_deg = 10;   ///< of a cone frustum
  double length_mm = 160, amplitude_mm = 40, lean_deg = 5, twist_deg = 15;  ///< of an S
};

/// Feed and chord tolerance are the defaults. @throws InputError for a centre that is not three numbers
ConeFrustum cone_frustum_of(const TestPieceSizes& sizes);
SShape s_shape_of(const TestPieceSizes& sizes);

/// The path of a piece of these sizes as a curve file (*.csv), which begins with them.
std::string cone_frustum_csv(const TestPieceSizes& sizes, const TestPiece& piece);
std::string s_shape_csv(const TestPieceSizes& sizes, const TestPiece& piece);

}  // namespace abbe
