#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "abbe/formats/evaluations/evaluation_circular_file.h"
#include "abbe/formats/evaluations/evaluation_line_file.h"
#include "abbe/formats/evaluations/evaluation_positioning.h"
#include "abbe/formats/evaluations/evaluation_rotation_file.h"
#include "abbe/formats/evaluations/temperature_record.h"
#include "abbe/study/evaluations/expansion_numbers.h"
#include "abbe/verify/evaluations/circular.h"
#include "abbe/verify/evaluations/circular_diagnosis.h"
#include "abbe/verify/evaluations/diagonals.h"
#include "abbe/verify/evaluations/positioning_uncertainty.h"
#include "abbe/verify/evaluations/rotation_error_motion.h"
#include "abbe/verify/evaluations/squareness.h"
#include "abbe/verify/evaluations/straightness.h"

namespace abbe {

// Tests of axes for evaluate_readings(); lengths in mm, angles in rad, speeds in mm/s. Readings are what the readers of
// files return.

/// Positioning of an axis (ISO 230-2).
///
/// Refused: what is known of a linear axis where the readings are those of a rotary one, and the other way round;
/// temperatures without a coefficient, and coefficients of a body without a temperature where another one has it.
struct PositioningTest {
  PositioningFile readings;
  /// What is known of the measurement, of a linear and of a rotary axis: --instrument-um, --instrument-arcsec, ...
  PositioningUncertaintyInput linear, rotary;
  /// Temperatures of a linear axis and of the instrument, besides those of the readings: deviations are corrected to 20
  /// degC. The coefficients are those of `linear`.
  ExpansionNumbers expansion{};
  std::optional<TemperatureRecord> temperatures{};  ///< --temperatures: over the time of the readings
};

/// A contribution to the uncertainty of a positioning test, as a user states it.
struct PositioningContribution {
  const char* option;                                  ///< of `abbe evaluate positioning`: "--instrument-um"
  PositioningUncertaintyInput PositioningTest::*axis;  ///< of a linear or of a rotary axis
  double PositioningUncertaintyInput::*value;
  double unit;        ///< of the option's value, in mm, rad, mm/mm, K, 1/K
  const char* words;  ///< what it is
};

/// All contributions, in the order of the options.
std::span<const PositioningContribution> positioning_contributions();

/// Positioning along diagonals (ISO 230-6).
struct DiagonalsTest {
  std::vector<DiagonalReadings> readings;
};

/// Circular test (ISO 230-4). The evaluation is refused where a circular deviation G has no value.
struct CircularTest {
  CircularFile readings;
  double nominal_radius = 0;  ///< --radius-mm: above zero; the one with which the file was read
  std::string plane;          ///< --plane: "XY", "YZ" or "ZX"; empty: as the file says, or else XY
  CircularCentre centre = CircularCentre::least_squares;  ///< --centre: from which radii are measured
  double reading_uncertainty = 0;                         ///< --u-reading-um: standard, of one reading; 0: not stated
  double length_uncertainty = 0;                          ///< --u-length-um: standard, of what all readings share
  bool length_calibrated = true;                          ///< --length-not-calibrated
  double reversal_margin = 0;    ///< --skip-reversal-deg: readings so near a reversal have no part in the causes
  double feed = 0;               ///< --feed-mm-min: along the path; 0: not known
  ExpansionNumbers expansion{};  ///< temperatures of the scales and the instrument: radii are corrected to 20 degC
};

/// The numerical results of a circular test, mm and rad.
struct CircularEvaluation {
  CircularResult deviations;
  CircularDiagnosis diagnosis;
};

/// Error motions of an axis of rotation (ISO 230-7). The evaluation is refused where the turns do not show them.
struct RotationTest {
  RotationReadings readings;
  RotationOptions options;
};

/// Straightness of a line (ISO 230-1), by both reference lines.
struct StraightnessTest {
  LineReadings readings;
  ReferenceLine reference = ReferenceLine::least_squares;  ///< --reference: of the plot
  double reading_uncertainty = 0;  ///< --u-reading-um: standard, of one deviation; 0: not stated
};

/// The numerical results of a straightness test, mm and rad.
struct StraightnessEvaluation {
  Straightness least_squares, minimum_zone;  ///< about each reference line
};

/// Squareness of two lines (ISO 230-1).
struct SquarenessTest {
  std::array<LineReadings, 2> readings;
  SquarenessOptions options;
};

}  // namespace abbe
