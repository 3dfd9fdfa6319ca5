#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/verify/evaluations/statistics.h"

namespace abbe {

struct Study;
struct StudyResult;

/// What the fit leaves of the readings that it used, against the uncertainty stated for them. Readings carry the noise
/// of their instruments: this is never called an error of the machine.
struct NoiseFigures {
  std::size_t residuals = 0;  ///< scalar ones, of all used readings
  std::size_t outliers = 0;   ///< readings marked as such, among the used ones
  /// Root of chi-square over degrees of freedom: 1 if model and stated uncertainties are right.
  double times_noise = 0, times_noise_without_outliers = 0;
};

/// The same, with a pass over all readings for their lengths.
struct ResidualFigures : NoiseFigures {
  /// Lengths of measured - modelled at each reading, mm; angles take no part. All used readings, then without outliers.
  SampleStatistics length, length_without_outliers;
};

NoiseFigures noise_figures(const Study& study, const StudyResult& result);
ResidualFigures residual_figures(const Study& study, const StudyResult& result);

/// "residual of the readings: ...", with and without the outliers.
std::string residual_text(const ResidualFigures& figures);

/// `residual` of the summary (docs/report-data.md).
nlohmann::ordered_json residual_json(const ResidualFigures& figures);

}  // namespace abbe
