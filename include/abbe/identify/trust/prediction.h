#pragma once

#include <Eigen/Core>
#include <vector>

#include "abbe/identify/identify.h"
#include "abbe/identify/weighed_observations.h"

namespace abbe {

/// The part of an identification that belongs to the machine's errors, over all of ErrorSet::parameters().
/// Parameters that were not estimated have variance 0.
Eigen::MatrixXd machine_covariance(const Identification& identification, std::size_t machine_parameter_count);

/// One reading that did not take part in the fit.
struct HeldOutReading {
  std::size_t observations = 0;
  std::size_t reading = 0;
  double norm = 0;               ///< Mahalanobis norm of its residuals against the readings' noise alone
  double prediction_ratio = 0;   ///< largest ratio of the prediction's standard uncertainty to that of a reading
  double normalised_square = 0;  ///< r' (I + J Cov J')^-1 r: chi-square of `rows` if model and uncertainties are right
};

/// Residuals of readings that were left out (use[k] = 0), with the uncertainty of their prediction.
/// @param problem  observations stand at the estimates
std::vector<HeldOutReading> held_out_readings(const Problem& problem, const Identification& identification,
                                              int threads = 0);

/// How many readings that took no part in the fit lie within what is stated about them.
struct ReadingCoverage {
  std::size_t components = 0;
  std::size_t components_within = 0;  ///< |measured - modelled| is at most 2 standard uncertainties
  std::size_t readings = 0;
  std::size_t readings_within = 0;  ///< all components of a reading together: in the region of the same probability
  /// Sums over several sets of readings.
  void add(const ReadingCoverage& more);
};

/// Compares readings with the identified model. The covariance of a difference is that of the prediction, J Cov J', and
/// that of the reading, with its variance factor and pose noise.
/// @param observations  readings that were not used, weighted as stated; at the estimates
/// @param setup         index of the observations of the problem whose unknowns they share
ReadingCoverage reading_coverage(const Observations& observations, const Identification& identification,
                                 std::size_t setup, const ReadingVariance& variance = {});

}  // namespace abbe
