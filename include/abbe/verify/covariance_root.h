#pragma once

#include <Eigen/Core>

namespace abbe {

/// Factor of a covariance of parameters in mm and rad side by side: factor * factor' = covariance, [n, n].
///
/// By the eigenvectors of the correlations, so that mm beside rad do not hide small variances; a parameter known
/// exactly stays exact. 0 x 0 of 0 x 0.
/// @throws std::invalid_argument if it has negative variances or numbers that are not finite, or is not positive
///         semi-definite (a smallest eigenvalue of the correlations below -1e-8 n)
Eigen::MatrixXd covariance_root(const Eigen::MatrixXd& covariance);

}  // namespace abbe
