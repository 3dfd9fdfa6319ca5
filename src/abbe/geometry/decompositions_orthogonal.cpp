#include <Eigen/SVD>

#include "abbe/geometry/decompositions.h"

namespace abbe {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Qr::Qr(const MatrixXd& matrix) : factors_(matrix) {}
MatrixXd Qr::upper(Index rows) const { return factors_.matrixQR().topRows(rows).triangularView<Eigen::Upper>(); }
MatrixXd Qr::orthonormal(Index count) const {
  return factors_.householderQ() * MatrixXd::Identity(factors_.rows(), count);
}
MatrixXd Qr::rotated(const MatrixXd& right) const { return factors_.householderQ() * right; }
MatrixXd Qr::rotated_from_right(const MatrixXd& left) const { return left * factors_.householderQ(); }
VectorXd Qr::rotated_back(const VectorXd& right) const { return factors_.householderQ().adjoint() * right; }
void Qr::in_place(MatrixXd& matrix) { Eigen::HouseholderQR<Eigen::Ref<MatrixXd>> factors(matrix); }

PivotedQr::PivotedQr(const MatrixXd& matrix) : factors_(matrix) {}
VectorXd PivotedQr::solve(const VectorXd& right) const { return factors_.solve(right); }
MatrixXd PivotedQr::upper(Index rows) const { return factors_.matrixQR().topRows(rows).triangularView<Eigen::Upper>(); }
MatrixXd PivotedQr::orthonormal(Index count) const {
  return factors_.householderQ() * MatrixXd::Identity(factors_.rows(), count);
}

CompleteOrthogonal::CompleteOrthogonal(const MatrixXd& matrix, double threshold) {
  if (threshold >= 0) factors_.setThreshold(threshold);
  factors_.compute(matrix);
}
VectorXd CompleteOrthogonal::solve(const VectorXd& right) const { return factors_.solve(right); }
MatrixXd CompleteOrthogonal::solve_columns(const MatrixXd& right) const { return factors_.solve(right); }
MatrixXd CompleteOrthogonal::pseudo_inverse() const { return factors_.pseudoInverse(); }

template <int N>
SingularValues<N>::SingularValues(const Matrix& matrix, unsigned int options) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, options);
  values_ = svd.singularValues();
  if (svd.computeU()) u_ = svd.matrixU();
  if (svd.computeV()) v_ = svd.matrixV();
}
template class SingularValues<3>;
template class SingularValues<Eigen::Dynamic>;

}  // namespace abbe
