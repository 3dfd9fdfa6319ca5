#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "abbe/identify/problem.h"

namespace abbe {

/// Readings of another campaign against errors that were identified without them.
struct IndependentReadings {
  std::size_t residuals = 0;  ///< that were compared, what is known of the set-ups beforehand included
  double chi_square = 0;      ///< of them, by the uncertainties of readings and errors together
  double degrees_of_freedom = 0;
  double p_value = 1;                 ///< probability of a larger chi-square if model and uncertainties are right
  std::size_t components = 0;         ///< of readings, that the fit of the set-ups does not reproduce anyway
  std::size_t components_within = 0;  ///< of these, that lie within 2 standard uncertainties
  /// [observations][readings] Mahalanobis norm of what is left, by all uncertainties; negative: not used.
  std::vector<std::vector<double>> norm;
};

/// Judges whether the uncertainties explain what is left of readings with the errors of the machine as identified and
/// the unknowns of the set-ups fitted to these readings.
///
/// r = J_x (x - x^) + J_s ds + e with the covariance C of the identified errors x^, and readings whitened so that e has
/// the identity: V = I + J_x C J_x'. The chi-square is the minimum over ds of (r - J_s ds)' V^-1 (r - J_s ds), with
/// residuals - rank(J_s) degrees of freedom. Norms are those of the residuals of the fit with the errors held, whose
/// covariance is I - H + (I - H) J_x C J_x' (I - H), H = J_s (J_s' J_s)^-1 J_s'. Derivation in docs/verify.md.
/// @param problem     estimates the unknowns of the set-ups alone; the observations stand at the estimates
/// @param covariance  [n, n] of ErrorSet::parameters() of problem.errors, mm and rad; variances may be 0
IndependentReadings judge_independent_readings(const Problem& problem, const Eigen::MatrixXd& covariance,
                                               int threads = 0);

}  // namespace abbe
