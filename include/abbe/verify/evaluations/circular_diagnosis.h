#pragma once

#include <array>
#include <string_view>

#include "abbe/verify/evaluations/circular.h"

namespace abbe {

/// Causes of radial deviations, in the order in which they are given. First and second are the axes of the plane;
/// angles run from the first to the second.
enum class CircularCause : std::uint8_t {
  centre_first,     ///< centre of the path along the first axis, mm (set-up)
  centre_second,    ///< along the second axis, mm (set-up)
  radius,           ///< mean radius less nominal radius, mm: both scales together, or a length not calibrated
  scale_mismatch,   ///< scale error of the first axis less that of the second, mm per mm
  scale_first,      ///< scale error of the first axis, mm per mm; only where the length is calibrated
  scale_second,     ///< likewise of the second
  squareness,       ///< angle between the positive axes less 90 degrees, rad (EC0Y in the XY plane)
  reversal_first,   ///< reversal value B of the first axis, mm: approach in positive less in negative direction
  reversal_second,  ///< likewise of the second
  servo_mismatch    ///< following error of the first axis less that of the second at the path's feed speed, mm
};
inline constexpr std::size_t kCircularCauses = 10;

struct CircularCauseValue {
  double value = 0;
  double uncertainty = 0;  ///< standard uncertainty from the residuals of the fit
  /// Share of the cause's pattern that no mixture of the others can imitate on these readings, 0..1.
  double distinctness = 0;
  /// False where distinctness is below kLeastDistinctness or the length is not calibrated: no value then.
  bool separable = false;
  double effect = 0;  ///< peak-to-peak radial deviation that this cause makes on the readings, mm
};

/// Below this share a cause is not told from the others: what is left out of the model would show up in it 50 times.
inline constexpr double kLeastDistinctness = 0.02;

enum class DiagnosisStatus {
  not_run,
  done,              ///< every cause is told from the others
  partly_separable,  ///< some are not: short arc, one direction only, or a length that is not calibrated
  too_few_readings   ///< not more than unknowns take part, or a reading without a radius
};

struct CircularDiagnosis {
  DiagnosisStatus status = DiagnosisStatus::not_run;
  std::array<CircularCauseValue, kCircularCauses> causes;  ///< by CircularCause
  double residual_rms = 0;                                 ///< standard deviation of what the causes leave, mm
  double residual_peak_to_peak = 0;                        ///< mm
  /// Readings that one independent reading is worth: above 1 where the residuals follow each other (Zieba and Ramza
  /// 2011); the uncertainties include it.
  double correlation_length = 1;
  std::array<std::vector<double>, 2> residuals;  ///< [n] mm, by CircularDirection
  std::array<std::vector<double>, 2> modelled;   ///< [n] mm, radial deviation that the causes explain, centre left out
};

struct DiagnosisOptions {
  double nominal_radius = 0;      ///< mm
  bool length_calibrated = true;  ///< false: the radius tells nothing of the scales, only of their difference
  double length_uncertainty = 0;  ///< standard uncertainty of the length, mm; goes into the scales
  /// Readings nearer than this to where an axis turns round take no part in the fit, rad: reversal spikes.
  double reversal_margin = 0;
};

/// Fit of the radial deviations of both directions (or one) to their causes; equations in docs/evaluate-geometry.md.
///
/// Linear about the least-squares centre of all readings (about the instrument's centre where the arc is too short for
/// one), so errors must be small against the radius. Rank: each cause is compared with the span of all others; one that
/// another mixture imitates is `separable = false`, others keep their values.
CircularDiagnosis circular_diagnosis(const std::array<CircularReadings, 2>& paths, const DiagnosisOptions& options);

}  // namespace abbe
