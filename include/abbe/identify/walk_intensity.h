#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/identify/identify.h"

namespace abbe {

/// Unknowns that wander with one intensity, which is sought: joint priors whose information is K / variance.
struct EstimatedWalk {
  std::string name;       ///< "tracker1 shifts"
  std::size_t setup = 0;  ///< index into Problem::observations
  bool is_angle = false;
  std::vector<std::size_t> priors;  ///< indices into Problem::joint_priors
  double variance = 0;              ///< of the given priors; afterwards as estimated: mm^2/s or rad^2/s
  double variance_uncertainty = 0;  ///< standard uncertainty
  /// The readings show no walk: a variance too small to matter is used. variance_uncertainty is then that of an
  /// estimate that could be negative.
  bool at_zero = false;
};

/// Identifies with the intensities of walks that make the readings most likely: restricted maximum likelihood.
///
/// With u the estimates of a walk, C their covariance, t its variance and A = K C / t, of n unknowns,
///
///     score = -(n - tr A)/(2 t) + u'K u/(2 t^2),    information_ij = tr((delta_ij I - A_ij)(delta_ij I - A_ji))/(2 t_i
///     t_j)
///
/// (A_ij = K_i C_ij / t_j): what RestrictedLikelihood has, with the unknowns that wander as random effects (Harville,
/// J. Am. Stat. Assoc. 72 (1977) 320; Searle, Casella and McCulloch, Variance Components (1992), 7.6). Fisher scoring
/// until the step is below 1e-6 of the standard uncertainties. The status is no_convergence if they do not settle.
/// @param problem  at the start; afterwards at the estimates, with the priors of the estimated variances
Identification identify_with_walks(Problem& problem, std::vector<EstimatedWalk>& walks,
                                   const IdentifyOptions& options = {});

}  // namespace abbe
