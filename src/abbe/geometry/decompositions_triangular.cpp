#include "abbe/geometry/decompositions.h"

namespace abbe {

template <int N>
FullLu<N>::FullLu(const Matrix& matrix) : factors_(matrix) {}
template <int N>
double FullLu<N>::reciprocal_condition() const {
  return factors_.rcond();
}
template <int N>
typename FullLu<N>::Vector FullLu<N>::solve(const Vector& right) const {
  return factors_.solve(right);
}
template <int N>
typename FullLu<N>::Matrix FullLu<N>::inverse() const {
  return factors_.inverse();
}
template <int N>
Eigen::MatrixXd FullLu<N>::kernel() const {
  return factors_.kernel();
}
template <int N>
Eigen::MatrixXd FullLu<N>::kernel_of(Eigen::Index dimension) const {
  const Eigen::Index size = factors_.rows(), rank = size - dimension;
  const auto& lu = factors_.matrixLU();
  Eigen::MatrixXd vectors(size, dimension);
  vectors.topRows(rank) = -lu.topRightCorner(rank, dimension);
  vectors.bottomRows(dimension).setIdentity();
  for (Eigen::Index k = 0; k < dimension; ++k) {
    for (Eigen::Index i = rank; i-- > 0;) {
      double sum = vectors(i, k);
      for (Eigen::Index j = i + 1; j < rank; ++j) sum -= lu(i, j) * vectors(j, k);
      vectors(i, k) = sum / lu(i, i);
    }
  }
  return factors_.permutationQ() * vectors;
}
template class FullLu<3>;
template class FullLu<6>;
template class FullLu<12>;
template class FullLu<Eigen::Dynamic>;

PartialLu::PartialLu(const Eigen::MatrixXd& matrix) : factors_(matrix) {}
Eigen::VectorXd PartialLu::solve(const Eigen::VectorXd& right) const { return factors_.solve(right); }
Eigen::MatrixXd PartialLu::solve_columns(const Eigen::MatrixXd& right) const { return factors_.solve(right); }
Eigen::MatrixXd PartialLu::inverse() const { return factors_.inverse(); }

}  // namespace abbe
