#pragma once

#include <array>
#include <span>

#include "abbe/verify/evaluations/straightness.h"

namespace abbe {

/// Readings along one of the two lines of a squareness test.
///
/// Deviations of the first line are positive along the positive direction of the second one, and the other way round.
struct SquarenessLine {
  std::span<const double> positions;   ///< [n] mm, along the line
  std::span<const double> deviations;  ///< [n] mm, across it, in the plane of both lines
};

struct SquarenessOptions {
  ReferenceLine reference = ReferenceLine::least_squares;
  double reading_uncertainty = 0;  ///< standard uncertainty of one deviation, mm; 0: not stated
  /// Angle between the positive arms of the reference square less 90 degrees, rad, and its standard uncertainty.
  double artefact = 0, artefact_uncertainty = 0;
};

struct Squareness {
  StraightnessStatus status = StraightnessStatus::not_run;  ///< done if both lines are
  std::array<Straightness, 2> lines;
  /// Angle between the positive directions of the two reference lines less 90 degrees, rad: the rotation of the second
  /// line about (first x second) relative to the first, as in EC0Y of ISO 230-1 for X and Y.
  double value = 0;
  double uncertainty = 0;  ///< standard uncertainty, rad
};

/// Squareness error between two lines of motion (ISO 230-1:2012).
///
/// A positive slope turns the first line towards the second and the second towards the first; both make the angle
/// smaller: value = -(slope_1 + slope_2) + artefact, with independent contributions to the uncertainty.
Squareness squareness(const SquarenessLine& first, const SquarenessLine& second, const SquarenessOptions& options = {});

}  // namespace abbe
