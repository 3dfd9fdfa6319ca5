#pragma once

#include <array>

#include "abbe/instruments/polygon/polygon.h"

namespace abbe {

/// The readings of one position in the order of PolygonReading, rad and mm.
using PolygonReadings = std::array<double, kPolygonReadings>;

/// All readings of one position, ray traced.
PolygonReadings polygon_readings(const Polygon& polygon, const PolygonMount& mount, const PolygonBench& bench,
                                 const PolygonPosition& position, const TableMotion& motion);

enum class PolygonInversionStatus { not_run, converged, not_converged, singular };

struct PolygonInversion {
  PolygonInversionStatus status = PolygonInversionStatus::not_run;
  TableMotion motion;
  int iterations = 0;
  /// Measured minus modelled about z by the second autocollimator, which the inversion does not use: shows what does
  /// not fit, rad. NaN if that reading is NaN (not measured).
  double redundant_residual = 0;
};

enum class PolygonInversionOrder {
  stepwise,     ///< the three angles from the autocollimators, then the displacements, which are linear in what is left
  simultaneous  ///< all six at once
};

/// The six error motions that explain six readings exactly, everything else known: Newton's method on the ray-traced
/// model, no small angles.
///
/// @param readings  autocollimator_y_about_z may be NaN: it is not needed
PolygonInversion invert_polygon_readings(const PolygonReadings& readings, const Polygon& polygon,
                                         const PolygonMount& mount, const PolygonBench& bench,
                                         const PolygonPosition& position,
                                         PolygonInversionOrder order = PolygonInversionOrder::stepwise);

/// First-order formulas (9) to (13) and (18) of the paper.
enum class PolygonFormula {
  printed,   ///< as printed: (11), (13) with wrong signs
  corrected  ///< with the signs that follow from the model
};

/// Error motions from readings by the first-order formulas: differences to the readings at the first position, where
/// the motions are taken to be zero, minus what known prism, mount and sensor positions explain.
///
/// With PolygonFaceOrder::face the corrected formulas take a face's tilt as a constant of the face; the printed ones
/// know only the paper's order. Errors of second order remain: 0.04 arcsec and 0.09 um in the paper's example.
TableMotion first_order_motion(PolygonFormula formula, const PolygonReadings& now, const PolygonReadings& start,
                               const Polygon& polygon, const PolygonMount& mount, const PolygonBench& bench,
                               const PolygonPosition& position, const PolygonPosition& start_position);

}  // namespace abbe
