#include <Eigen/Eigenvalues>
#include <cmath>

#include "abbe/geometry/decompositions.h"

namespace abbe {

template <int N>
GeneralEigenvalues<N>::GeneralEigenvalues(const Eigen::Matrix<double, N, N>& matrix) {
  const Eigen::EigenSolver<Eigen::Matrix<double, N, N>> solver(matrix, false);
  info_ = solver.info();
  if (info_ == Eigen::Success) {
    values_ = solver.eigenvalues();
  } else {
    values_.setConstant(std::nan(""));
  }
}
template class GeneralEigenvalues<24>;

GeneralEigenvectors::GeneralEigenvectors(const Eigen::MatrixXd& matrix) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix);
  info_ = solver.info();
  if (info_ == Eigen::Success) {
    values_ = solver.eigenvalues();
    vectors_ = solver.eigenvectors();
  } else {
    values_ = Eigen::VectorXcd::Constant(matrix.rows(), std::nan(""));
    vectors_ = Eigen::MatrixXcd::Constant(matrix.rows(), matrix.rows(), std::nan(""));
  }
}

}  // namespace abbe
