#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace abbe {

/// Reference straight line of ISO 230-1: least squares, or the middle of the narrowest zone that holds every deviation.
enum class ReferenceLine { least_squares, minimum_zone };

/// Positions nearer than this are one position to the minimum zone, mm: no slope is taken over such a distance.
inline constexpr double kSamePosition = 1e-9;

enum class StraightnessStatus {
  not_run,
  done,
  too_few_positions  ///< fewer than three different positions: every line is straight then
};

/// A reference straight line: offset + slope * (position - origin).
struct StraightLine {
  double origin = 0;  ///< mean position, mm
  double offset = 0;  ///< mm
  double slope = 0;   ///< rad (mm per mm)
  double at(double position) const { return offset + slope * (position - origin); }
};

/// Straightness about one reference line; all lengths in mm, along the direction in which deviations were read.
struct Straightness {
  StraightnessStatus status = StraightnessStatus::not_run;
  StraightLine line;
  std::vector<double> positions;   ///< [n] mm, in the order of the readings
  std::vector<double> deviations;  ///< [n] from the line, in the same order
  double value = 0;                ///< straightness error: largest less smallest deviation, never negative
  double largest = 0, smallest = 0;
  std::size_t largest_at = 0, smallest_at = 0;  ///< readings that touch the zone
  double scatter = 0;                           ///< standard deviation about the least-squares line, n - 2
  /// Standard uncertainty of `value` from the stated uncertainty of a reading; 0 if none was stated.
  double value_uncertainty = 0;
  /// Standard uncertainty of the slope, rad: from the stated uncertainty of a reading or from the scatter, whichever is
  /// larger.
  double slope_uncertainty = 0;
};

/// Straightness error of deviations read at positions along a line (ISO 230-1:2012).
///
/// Deviations and zone are measured along the direction of the readings, not across the line; for a slope s that is a
/// factor of 1 + s^2/2. The minimum zone is exact: the width max(y - s x) - min(y - s x) is convex and piecewise linear
/// in the slope s, and its corners are the slopes of the edges of the upper and lower convex hull (O(n log n)). Where a
/// range of slopes gives the same width, the one nearest to the least-squares line is taken, and the range enters the
/// uncertainty of the slope as a rectangular distribution.
/// @param positions  [n] mm, any order, may repeat
/// @param deviations [n] mm
/// @param reading_uncertainty  standard uncertainty of one deviation, mm, independent between readings; 0: not stated
/// Source: docs/evaluate-geometry.md (derivation of the uncertainties).
Straightness straightness(std::span<const double> positions, std::span<const double> deviations,
                          ReferenceLine reference, double reading_uncertainty = 0);

}  // namespace abbe
