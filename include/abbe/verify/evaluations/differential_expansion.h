#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "abbe/verify/evaluations/positioning.h"

namespace abbe {

/// A body whose expansion affects readings of lengths: the scale (or screw) of an axis, or that of an instrument.
struct ExpandingBody {
  double coefficient = 0;              ///< alpha, 1/K
  double coefficient_uncertainty = 0;  ///< standard, 1/K
  double temperature_uncertainty = 0;  ///< standard, of its own thermometer, the same at all readings, K
  double fixed_point = 0;              ///< mm: position of the axis at which the body is where it is at 20 degC
};

/// Effect of axis and instrument on readings at temperatures other than 20 degC.
struct DifferentialExpansion {
  ExpandingBody machine, instrument;
  double common_temperature_uncertainty = 0;  ///< standard, of what both thermometers share (a calibration), K
  bool has_uncertainty() const;
};

/// Temperatures of both bodies at one reading, degC.
struct BodyTemperatures {
  double machine = 20, instrument = 20;
};

/// Nominal differential expansion at a position: alpha_m (T_m - 20) (x - x_m) - alpha_i (T_i - 20) (x - x_i), mm. A
/// warm scale moves the axis too far, and a warm instrument reads too little: a deviation at these temperatures is
/// larger by it than at 20 degC. Source: ISO 230-2:2014 (correction to 20 degC); signs: docs/conventions.md.
double nominal_differential_expansion(const DifferentialExpansion& expansion, double position,
                                      const BodyTemperatures& at);

/// Deviations as they would be with both bodies at 20 degC (ISO 1). @param at  [readings]
std::vector<PositioningReading> corrected_to_reference_temperature(const std::vector<PositioningReading>& readings,
                                                                   const DifferentialExpansion& expansion,
                                                                   const std::vector<BodyTemperatures>& at);

/// Effect of one uncertain quantity on all readings together.
struct ExpansionContribution {
  const char* name;
  std::vector<double> standard;  ///< [readings] mm, with a sign: by one standard uncertainty of the quantity
};

/// Contributions of a correction, those that are not zero; independent of each other, each the same quantity at all
/// readings, so that the covariance of two deviations is the sum of the products of their entries.
///
/// A coefficient contributes u(alpha) (T - 20) (x - x_0), a temperature sqrt(alpha^2 + u^2(alpha)) u(T) (x - x_0),
/// which makes the variance of alpha (T - 20) exact; what both thermometers share acts on alpha_m (x - x_m) - alpha_i
/// (x - x_i). Source: ISO/TR 16015:2003; JCGM 100:2008, H.1.
std::vector<ExpansionContribution> expansion_contributions(const std::vector<PositioningReading>& readings,
                                                           const DifferentialExpansion& expansion,
                                                           const std::vector<BodyTemperatures>& at);

/// Figures of ISO 230-2: A, A+, A-, E, E+, E-, M, R, R+, R-, B, mean of B.
inline constexpr std::size_t kPositioningFigures = 12;
std::array<EvaluatedFigure, kPositioningFigures> positioning_figures(const PositioningEvaluation& evaluation);

/// Expanded uncertainties (k = 2) of these figures by the contributions, mm; 0 for figures that are not evaluated.
///
/// Each contribution changes all readings together by twice its standard uncertainty, in either sense, and the figures
/// are evaluated again: the larger change counts, so that extremes that move to other targets are seen (JCGM 100:2008,
/// 5.1.3 note 2). The root sum of squares is taken over the contributions.
/// @param corrected  readings of the evaluation
std::array<double, kPositioningFigures> expanded_by_expansion(const std::vector<PositioningReading>& corrected,
                                                              const std::vector<ExpansionContribution>& contributions);

}  // namespace abbe
