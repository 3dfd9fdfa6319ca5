#pragma once

#include <vector>

#include "abbe/machine/test_piece.h"

namespace abbe {

class Subcommand;

/// Sizes of a test piece as people give them: the same options wherever one is named.
struct TestPieceSizes {
  std::vector<double> centre_mm;  ///< empty: the piece's default
  double tool_diameter_mm = 20, height_mm = 0, azimuth_deg = 0;
  double base_diameter_mm = 80, half_apex_deg = 15, inclination_deg = 10;
  double length_mm = 160, amplitude_mm = 40, lean_deg = 5, twist_deg = 15;
};

void add_cone_frustum_sizes(Subcommand& piece, TestPieceSizes& sizes);
void add_s_shape_sizes(Subcommand& piece, TestPieceSizes& sizes);

/// Feed and chord tolerance are the defaults. @throws InputError for a centre that is not three numbers
ConeFrustum cone_frustum_of(const TestPieceSizes& sizes);
SShape s_shape_of(const TestPieceSizes& sizes);

}  // namespace abbe
