#pragma once

#include <memory>
#include <string>
#include <vector>

#include "abbe/identify/restricted_likelihood.h"

namespace abbe {

/// Which variances of the readings are estimated from their residuals; the others stay as stated (factor 1, no noise).
struct VarianceComponentChoice {
  bool variance_factor = false;  ///< of the covariances stated for the readings, one for all observations
  bool pose_noise =
      false;              ///< of a displacement common to all readings at one pose, or as SelectedObservations::common
  bool by_block = false;  ///< that says which belong to one block of time: for words
  int max_iterations = 50;  ///< identifications
  bool any() const { return variance_factor || pose_noise; }
};

/// Variances of the readings, estimated together with the parameters.
struct VarianceComponents {
  VarianceComponentChoice estimated;
  bool converged = false;
  int iterations = 0;  ///< identifications
  ReadingVariance variance;
  /// Covariance of (variance factor, pose variance), inverse of the information; 0 of what is not estimated.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  /// The estimate is 0, the smallest possible variance: the readings show no common noise. The covariance is then that
  /// of an estimate that could be negative.
  bool pose_noise_at_zero = false;
  double stated_chi_square = 0;  ///< of the fit with the uncertainties as stated
  double stated_degrees_of_freedom = 0;
  double stated_p_value = 0;

  /// Standard uncertainty of the variance factor.
  double variance_factor_uncertainty() const;
  /// Standard deviation of each coordinate of the common displacement, mm.
  double pose_noise() const;
  /// Its standard uncertainty, mm; if it is zero, the root of twice the standard uncertainty of the variance.
  double pose_noise_uncertainty() const;
};

/// An identification whose readings are weighted with estimated variances.
struct WeighedIdentification {
  Identification identification;
  VarianceComponents components;
  std::vector<std::shared_ptr<WeighedObservations>> observations;
  Problem problem;  ///< the given one with these observations: what the identification solved
};

/// Estimates variances of the readings by restricted maximum likelihood together with the parameters.
///
/// Fisher scoring: the problem is identified with the present variances, then the variances take a step along
/// information^-1 score, until the step is below 1e-6 of their standard uncertainties. Every round begins at the start
/// of the problem, so that the result is that of identify() with the final variances. Least squares only.
/// The status of the identification is rank_deficient if the variances cannot be told apart, no_convergence if they do
/// not settle; the message says which.
/// @param problem  observations as stated, at the start; afterwards at the estimates, as with identify()
WeighedIdentification identify_with_variances(Problem& problem, const VarianceComponentChoice& choice,
                                              const IdentifyOptions& options = {});

}  // namespace abbe
