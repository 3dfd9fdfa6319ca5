#include "test_piece/sizes.h"

#include "options.h"

namespace abbe {
namespace {

/// Of a piece and of a tool, mm: wider than any that a machine takes.
constexpr double kSmallestSize = 0.01, kLargestSize = 10000;

void add_common(Subcommand& piece, TestPieceSizes& sizes, const char* centre, const char* height) {
  piece.add_option("--centre-mm", sizes.centre_mm, centre)->expected(3)->check(in_range(-kLargestSize, kLargestSize));
  piece.add_option("--height-mm", sizes.height_mm, height)->check(in_range(kSmallestSize, kLargestSize));
  piece.add_option("--tool-diameter-mm", sizes.tool_diameter_mm, "Diameter of the cylindrical cutter")
      ->check(in_range(kSmallestSize, kLargestSize))
      ->capture_default_str();
  piece.add_option("--azimuth-deg", sizes.azimuth_deg, "Turn of the piece about Z")
      ->check(in_range(-360.0, 360.0))
      ->capture_default_str();
}

}  // namespace

void add_cone_frustum_sizes(Subcommand& piece, TestPieceSizes& sizes) {
  add_common(piece, sizes, "Centre of the base, workpiece frame (default 0 60 40)", "Along the axis (default 20)");
  piece.add_option("--base-diameter-mm", sizes.base_diameter_mm, "Diameter of the base")
      ->check(in_range(kSmallestSize, kLargestSize))
      ->capture_default_str();
  piece.add_option("--half-apex-deg", sizes.half_apex_deg, "Half of the angle at the apex")
      ->check(in_range(0.0, 90.0))
      ->capture_default_str();
  piece.add_option("--inclination-deg", sizes.inclination_deg, "Of the cone's axis from +Z")
      ->check(in_range(0.0, 90.0))
      ->capture_default_str();
}

void add_s_shape_sizes(Subcommand& piece, TestPieceSizes& sizes) {
  add_common(piece, sizes, "Middle of the foot, workpiece frame (default 0 0 30)", "Along Z (default 40)");
  piece.add_option("--length-mm", sizes.length_mm, "From end to end along X")
      ->check(in_range(kSmallestSize, kLargestSize))
      ->capture_default_str();
  piece.add_option("--amplitude-mm", sizes.amplitude_mm, "Of the sine that is the foot")
      ->check(in_range(-kLargestSize, kLargestSize))
      ->capture_default_str();
  piece.add_option("--lean-deg", sizes.lean_deg, "Lean of the wall at its ends")
      ->check(in_range(-45.0, 45.0))
      ->capture_default_str();
  piece.add_option("--twist-deg", sizes.twist_deg, "Lean of the wall at the crests, to either side")
      ->check(in_range(-45.0, 45.0))
      ->capture_default_str();
}

}  // namespace abbe
