#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "abbe/verify/evaluations/circle_centre.h"

namespace abbe {

/// Centre about which radii are taken.
enum class CircularCentre {
  least_squares,  ///< Gauss: the usual evaluation of a full circle
  minimum_zone,   ///< the smallest separation there is
  instrument      ///< where the instrument stands: set-up errors are in the result
};

enum class CircularDirection : std::uint8_t { clockwise, counterclockwise };

struct CircularOptions {
  double nominal_radius = 0;  ///< mm, above zero
  CircularCentre centre = CircularCentre::least_squares;
  double reading_uncertainty =
      0;  ///< standard uncertainty of one radius, independent between readings, mm; 0: not stated
  double length_uncertainty = 0;  ///< standard uncertainty of what all radii share (length, temperature), mm
};

/// A path, or both together, about one centre. Lengths in mm.
struct CircularDeviation {
  CircleStatus status = CircleStatus::not_run;  ///< of the centre; values exist only with `done`
  bool partial = false;                         ///< an arc: the standard centres full circles only
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double mean_radius = 0;          ///< radius of the least-squares circle about the centre
  std::vector<double> angle;       ///< [n] rad, seen from the centre
  std::vector<double> deviations;  ///< [n] radius about the centre less nominal radius
  /// Circular deviation G: largest less smallest radius; of both directions together G(b).
  double circular = 0, circular_uncertainty = 0;
  /// Radial deviation F: largest and smallest deviation from the nominal radius, with sign.
  double radial_largest = 0, radial_smallest = 0;
  double radial_largest_uncertainty = 0, radial_smallest_uncertainty = 0;
  std::size_t largest_at = 0, smallest_at = 0;
};

struct CircularResult {
  std::array<CircularDeviation, 2> paths;  ///< by CircularDirection; not_run where there are no readings
  /// Both directions about their common centre: `circular` is G(b). not_run with one direction only. Readings are those
  /// of the clockwise path, then those of the counter-clockwise one.
  CircularDeviation both;
  /// Mean bidirectional radial deviation D: mean of the two mean radii less the nominal radius; only if both are done.
  bool has_mean = false;
  double mean = 0, mean_uncertainty = 0;
};

/// Circular tests of ISO 230-4: G and F of each direction, G(b) and D of both.
///
/// Standard uncertainties follow from those of the readings: of a difference of two readings about a fitted centre for
/// G, of one reading and of the length for F (docs/evaluate-geometry.md). They do not include that the largest of many
/// noisy readings is too large on average.
/// @param paths  readings by CircularDirection; empty where that direction was not driven
CircularResult circular_deviations(const std::array<CircularReadings, 2>& paths, const CircularOptions& options);

}  // namespace abbe
