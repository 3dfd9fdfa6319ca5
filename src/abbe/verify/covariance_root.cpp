#include "abbe/verify/covariance_root.h"

#include <stdexcept>

#include "abbe/geometry/decompositions.h"

namespace abbe {

Eigen::MatrixXd covariance_root(const Eigen::MatrixXd& covariance) {
  if (!covariance.allFinite() || (covariance.diagonal().array() < 0).any()) {
    throw std::invalid_argument("covariance with negative variances or numbers that are not finite");
  }
  const Eigen::Index n = covariance.rows();
  // Eigen's solver needs a largest element: errors without any uncertainty have a covariance of 0 x 0.
  if (n == 0) return covariance;
  const Eigen::VectorXd u = covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd scale = u.unaryExpr([](double value) { return value > 0 ? 1 / value : 0.0; });
  const Eigen::MatrixXd correlation =
      scale.asDiagonal() * (0.5 * (covariance + covariance.transpose())) * scale.asDiagonal();
  const SymmetricEigen<> eigen(correlation);
  if (eigen.eigenvalues().minCoeff() < -1e-8 * static_cast<double>(n)) {
    throw std::invalid_argument("covariance is not positive semi-definite");
  }
  return u.asDiagonal() * eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

}  // namespace abbe
