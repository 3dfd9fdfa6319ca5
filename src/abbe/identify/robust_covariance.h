#pragma once

#include <Eigen/Core>
#include <vector>

#include "abbe/identify/identify.h"

namespace abbe {

/// Covariance of estimates made with a robust loss: (aH + P)^-1 (bH + P) (aH + P)^-1, H = J'J of the readings, P the
/// information of the priors, which no loss touches; a the mean of trace Psi' / m over the readings, b the mean of
/// |psi|^2 / m times K^2, K = 1 + (p / N) (c / a^2 - 1) for p free parameters, N residuals and c the mean of
/// trace (Psi' Psi') / m. Without priors this is b / a^2 (J'J)^-1. Source: Huber, Robust Statistics, 1981, 7.6;
/// docs/identification.md derives it.

/// The moments a, b (with K^2) and c. Readings listed as outliers contribute what they have, the others what normal
/// residuals of the stated size have on average: the covariance states what the stated uncertainties come to, with a
/// robust loss as with least squares.
/// @param norms  per observations, per reading; negative: not used
LossMoments robust_moments(const Problem& problem, const std::vector<std::vector<double>>& norms,
                           const std::vector<Outlier>& outliers, const Loss& loss, double free_parameters);

/// aH + P from H + P. @param prior_rows  [rows, p], P = prior_rows' prior_rows; may be empty
Eigen::MatrixXd robust_curvature(const Eigen::MatrixXd& normal, const Eigen::MatrixXd& prior_rows,
                                 const LossMoments& moments);

/// The same for factors: R_a with R_a'R_a = aH + P from R with R'R = H + P.
Eigen::MatrixXd robust_factor(const Eigen::MatrixXd& factor, const Eigen::MatrixXd& prior_rows,
                              const LossMoments& moments);

/// Turns C = (aH + P)^-1, in whatever gauge, into (b / a) C + (1 - b / a) C P C, which is the covariance above.
void spread_of_robust_estimates(const Eigen::MatrixXd& prior_rows, const LossMoments& moments,
                                Eigen::MatrixXd& covariance);

}  // namespace abbe
