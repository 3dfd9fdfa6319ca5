#pragma once

#include <cstdint>

#include "abbe/verify/thermal/time_series.h"

namespace abbe {

enum class ResponseStatus : std::uint8_t {
  not_run,
  done,
  too_few_readings,  ///< or too few that are independent of each other
  no_change,         ///< no more than the scatter of the readings
  not_first_order,   ///< what the fit leaves has a pattern and is more than a twentieth of the change
  not_identified     ///< the readings do not bound the time constant: they end too early, or are too far apart
};

/// Fewest readings for a fit.
inline constexpr std::size_t kLeastResponseReadings = 6;

/// A displacement that approaches its final value exponentially: start + change (1 - exp(-(t - from) / time constant)).
struct FirstOrderResponse {
  ResponseStatus status = ResponseStatus::not_run;
  double from = 0, to = 0;        ///< s: the times of the fit; what follows exists only with `done`
  double start = 0;               ///< value at `from`, mm or rad
  double change = 0;              ///< from there to the final value, which the readings need not have reached
  double time_constant = 0;       ///< s
  double uncertainty = 0;         ///< standard, of the time constant, s
  double residual_rms = 0;        ///< with the degrees of freedom of the fit
  double correlation_length = 1;  ///< readings that one independent reading is worth, from the residuals

  double at(double time) const;
};

/// Fits a first-order response to the readings between two times by least squares.
///
/// For a given time constant the model is linear; the sum of squares S is minimised over the logarithm of the time
/// constant. Its uncertainty is that of the profile: half the larger distance from the minimum at which S has grown by
/// 4 s^2, where s^2 = S / (n / c - 3) or the square of the stated uncertainty of a reading, whichever is larger, and c
/// the correlation length. A time constant is refused where S does not grow so much between a tenth of the shortest
/// time between readings and ten times their duration. Source: docs/evaluate-thermal.md.
/// @param reading_uncertainty  standard, of one reading, independent of the others; 0: not stated
FirstOrderResponse first_order_response(const TimeSeries& series, double from, double to,
                                        double reading_uncertainty = 0);

}  // namespace abbe
