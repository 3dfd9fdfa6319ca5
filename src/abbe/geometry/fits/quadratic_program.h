#pragma once

#include <Eigen/Core>

/// Inside of the fits: small convex programs.
namespace abbe::fits {

/// min c.x + x.Qx / 2 subject to C x <= b by Mehrotra's predictor-corrector; x strictly inside at the start.
///
/// @param quadratic  Q, positive semi-definite; zero: a linear program
/// @return multipliers of the rows, empty if it did not end
/// Source: S. Mehrotra, SIAM J. Optim. 2 (1992) 575.
Eigen::VectorXd quadratic_program(const Eigen::MatrixXd& rows, const Eigen::VectorXd& bound,
                                  const Eigen::VectorXd& cost, const Eigen::MatrixXd& quadratic, Eigen::VectorXd& x);

}  // namespace abbe::fits
