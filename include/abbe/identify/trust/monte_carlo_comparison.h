#pragma once

#include <cstddef>
#include <vector>

#include "abbe/identify/trust/monte_carlo.h"

namespace abbe {

/// One parameter's standard uncertainty by simulation beside that from the covariance.
struct UncertaintyRatio {
  std::size_t parameter = 0;
  double ratio = 0;  ///< simulated / from the covariance
  double shift = 0;  ///< (simulated mean - estimate) / standard uncertainty from the covariance
};

/// Does a Monte Carlo simulation confirm the covariance of an identification?
///
/// With a linear model and normal readings the simulated variance of a parameter is distributed as
/// chi-square(M - 1) / (M - 1) times the variance from the covariance, the simulated mean normally about the estimate
/// with u / sqrt(M); M samples. The limits below are so wide that all ratios and all shifts of a linear model together
/// stay within them with probability 1 - significance or more (Bonferroni): a ratio beyond them is no chance, but
/// nonlinearity, or a covariance that belongs to something else than what was simulated.
/// Source: JCGM 101:2008, 8 (validation of the GUM uncertainty framework by Monte Carlo); sampling distributions of
/// mean and variance of normal samples.
struct MonteCarloComparison {
  std::vector<UncertaintyRatio> parameters;  ///< those that are uncertain, in the order of the estimates
  std::size_t samples = 0;                   ///< M
  double ratio_low = 0, ratio_high = 0;      ///< limits of the ratios
  double shift_limit = 0;                    ///< limit of the magnitude of the shifts
  double smallest_ratio = 0, largest_ratio = 0, largest_shift = 0;
  std::size_t beyond = 0;  ///< parameters whose ratio or shift is beyond its limits

  /// True if there was something to compare and nothing is beyond the limits.
  bool agrees() const { return !parameters.empty() && beyond == 0; }
};

/// @param significance  probability that a linear model is said to disagree, 0 < significance < 1
/// @returns no parameters unless `simulated` is done and belongs to `identification`
MonteCarloComparison compare_with_covariance(const Identification& identification, const MonteCarloResult& simulated,
                                             double significance = 0.01);

}  // namespace abbe
