#include <Eigen/Eigenvalues>

#include "abbe/geometry/decompositions.h"

namespace abbe {

template <int N>
SymmetricEigen<N>::SymmetricEigen(const Matrix& matrix, int options) {
  // Of three rows sums have another order than of any number.
  const Eigen::SelfAdjointEigenSolver<std::conditional_t<N == 3, Matrix, Eigen::MatrixXd>> solver(matrix, options);
  info_ = solver.info();
  values_ = solver.eigenvalues();
  if (options & Eigen::ComputeEigenvectors) vectors_ = solver.eigenvectors();
}
template class SymmetricEigen<2>;
template class SymmetricEigen<3>;
template class SymmetricEigen<5>;
template class SymmetricEigen<6>;
template class SymmetricEigen<Eigen::Dynamic>;

template <int N>
Ldlt<N>::Ldlt(const Matrix& matrix) : factor_(matrix) {}
template <int N>
typename Ldlt<N>::Vector Ldlt<N>::solve(const Vector& right) const {
  return factor_.solve(right);
}
template <int N>
Eigen::MatrixXd Ldlt<N>::solve_columns(const Eigen::MatrixXd& right) const {
  return factor_.solve(right);
}
template class Ldlt<5>;
template class Ldlt<6>;
template class Ldlt<Eigen::Dynamic>;

void Cholesky::compute(const Eigen::MatrixXd& matrix) { factor_.compute(matrix); }
Eigen::VectorXd Cholesky::solve(const Eigen::VectorXd& right) const { return factor_.solve(right); }
Eigen::MatrixXd Cholesky::solve_columns(const Eigen::MatrixXd& right) const { return factor_.solve(right); }
Eigen::MatrixXd Cholesky::half_solve(const Eigen::MatrixXd& right) const { return factor_.matrixL().solve(right); }

}  // namespace abbe
