#pragma once

#include <cstddef>
#include <vector>

#include "abbe/identify/identify.h"

namespace abbe {

/// Predictions of one set-up's observations with their uncertainty, for readings that took no part in the fit.
struct PredictedReadings {
  std::vector<double> error;        ///< length of measured - modelled, mm
  std::vector<double> uncertainty;  ///< root of the trace of the prediction's covariance, mm
  std::size_t within = 0;           ///< coordinates within 2 u of the prediction
  std::size_t coordinates = 0;
};

/// @param observations  weighted with 1 um in every length, so that residuals and derivatives are in um; angles take no
///                      part
/// @param setup         index of the set-up whose unknowns they share
PredictedReadings predict_readings(const Observations& observations, const Identification& identification,
                                   std::size_t setup);

}  // namespace abbe
