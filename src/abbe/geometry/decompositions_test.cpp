#include "abbe/geometry/decompositions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/geometry/fits/numbers_for_test.h"

namespace abbe {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Full, badly scaled, singular, indefinite, diagonal.
MatrixXd some_matrix(test::Numbers& numbers, Eigen::Index n, int k) {
  MatrixXd a = MatrixXd::NullaryExpr(n, n, [&] { return numbers.uniform(-1, 1); });
  if (k % 3 == 0) a.col(0) *= 1e-4;
  if (k % 7 == 0) a.row(n - 1).setZero();
  return a;
}
MatrixXd some_symmetric_matrix(test::Numbers& numbers, Eigen::Index n, int k) {
  const MatrixXd a = some_matrix(numbers, n, k);
  if (k % 11 == 0) return a.diagonal().asDiagonal();
  if (k % 5 == 0) return a + a.transpose();
  return a * a.transpose();
}

template <int N>
void expect_the_matrix_back_at_fixed_size() {
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;
  test::Numbers numbers(N);
  for (int k = 0; k < 2000; ++k) {
    const Matrix a = some_matrix(numbers, N, k), s = some_symmetric_matrix(numbers, N, k);
    const Vector right = some_matrix(numbers, N, 1).col(0);
    const SymmetricEigen<N> eigen(s);
    for (int i = 1; i < N; ++i) ASSERT_LE(eigen.eigenvalues()[i - 1], eigen.eigenvalues()[i]) << k;
    ASSERT_LT((s * eigen.eigenvectors() - eigen.eigenvectors() * eigen.eigenvalues().asDiagonal()).norm(), 1e-13) << k;
    ASSERT_LT((eigen.eigenvectors().transpose() * eigen.eigenvectors() - Matrix::Identity()).norm(), 1e-13) << k;
    const Matrix safe = a * a.transpose() + Matrix::Identity();
    const Vector image = safe * right;
    if constexpr (N >= 5) {
      ASSERT_LT((Ldlt<N>(safe).solve(image) - right).norm(), 1e-12) << k;
    }
    if constexpr (N == 3 || N == 6) {
      ASSERT_LT((FullLu<N>(safe).solve(image) - right).norm(), 1e-12) << k;
      ASSERT_LT((FullLu<N>(safe).inverse() * image - right).norm(), 1e-12) << k;
      // By the largest sums of columns. The estimate errs to one side only.
      const double condition =
          safe.cwiseAbs().colwise().sum().maxCoeff() * FullLu<N>(safe).inverse().cwiseAbs().colwise().sum().maxCoeff();
      ASSERT_GT(FullLu<N>(safe).reciprocal_condition() * condition, 1 - 1e-12) << k;
      ASSERT_LT(FullLu<N>(safe).reciprocal_condition() * condition, 10) << k;
    }
    if constexpr (N == 3) {
      const SingularValues<3> svd(a);
      ASSERT_GE(svd.values()[2], 0) << k;
      ASSERT_GE(svd.values()[0], svd.values()[1]) << k;
      ASSERT_GE(svd.values()[1], svd.values()[2]) << k;
      ASSERT_LT((svd.u() * svd.values().asDiagonal() * svd.v().transpose() - a).norm(), 1e-13) << k;
      ASSERT_LT((svd.u().transpose() * svd.u() - Matrix::Identity()).norm(), 1e-13) << k;
    }
  }
}

TEST(Decompositions, OfFixedSizeGiveTheMatrixBack) {
  expect_the_matrix_back_at_fixed_size<2>();
  expect_the_matrix_back_at_fixed_size<3>();
  expect_the_matrix_back_at_fixed_size<5>();
  expect_the_matrix_back_at_fixed_size<6>();
}

TEST(Decompositions, GiveTheMatrixBack) {
  test::Numbers numbers(7);
  for (int k = 1; k < 60; ++k) {
    const Eigen::Index n = 1 + k % 9;
    const MatrixXd a = some_matrix(numbers, n, 1), s = some_symmetric_matrix(numbers, n, 1);
    const MatrixXd q = Qr(a).orthonormal(n);
    EXPECT_LT((q * Qr(a).upper(n) - a).norm(), 1e-13);
    EXPECT_LT((Qr(a).rotated(MatrixXd::Identity(n, n)) - q).norm(), 1e-14);
    EXPECT_LT((Qr(a).rotated_from_right(MatrixXd::Identity(n, n)) - q).norm(), 1e-14);
    EXPECT_LT((Qr(a).rotated_back(a.col(0)) - q.transpose() * a.col(0)).norm(), 1e-14);
    const PivotedQr pivoted(a);
    EXPECT_LT((pivoted.orthonormal(n) * pivoted.upper(n) - a * pivoted.columns()).norm(), 1e-13);
    const SymmetricEigen<> eigen(s);
    EXPECT_LT((eigen.eigenvectors() * eigen.eigenvalues().asDiagonal() * eigen.eigenvectors().transpose() - s).norm(),
              1e-13);
    EXPECT_EQ(SymmetricEigen<>(s, Eigen::EigenvaluesOnly).eigenvectors().size(), 0);
    const SingularValues<> svd(a);
    EXPECT_LT((svd.u() * svd.values().asDiagonal() * svd.v().transpose() - a).norm(), 1e-13);
    const MatrixXd safe = s + MatrixXd::Identity(n, n);  // well conditioned
    const VectorXd x = a.col(0), b = safe * x;
    EXPECT_LT((Cholesky(safe).solve(b) - x).norm(), 1e-12);
    EXPECT_LT(std::abs(Cholesky(safe).half_solve(b).squaredNorm() - x.dot(b)), 1e-12);
    EXPECT_LT((Ldlt<>(safe).solve(b) - x).norm(), 1e-12);
    EXPECT_LT((PivotedQr(safe).solve(b) - x).norm(), 1e-12);
    EXPECT_LT((CompleteOrthogonal(safe).pseudo_inverse() * b - x).norm(), 1e-12);
    EXPECT_LT((FullLu<>(safe).inverse() * b - x).norm(), 1e-12);
    EXPECT_LT((PartialLu(safe).solve(b) - x).norm(), 1e-12);
    EXPECT_LT((PartialLu(safe).inverse() * b - x).norm(), 1e-12);
    EXPECT_LT((CompleteOrthogonal(safe).solve_columns(b) - x).norm(), 1e-12);
  }
}

TEST(Decompositions, SayWhatIsSingular) {
  MatrixXd a(3, 3);
  a << 1, 2, 3, 2, 4, 6, 1, 0, 1;
  EXPECT_EQ(PivotedQr(a).rank(), 2);
  EXPECT_EQ(CompleteOrthogonal(a).rank(), 2);
  EXPECT_EQ(FullLu<>(a).rank(), 2);
  EXPECT_EQ(FullLu<>(a).kernel_dimension(), 1);
  EXPECT_LT((a * FullLu<>(a).kernel()).norm(), 1e-14);
  EXPECT_EQ(Cholesky(-MatrixXd::Identity(2, 2)).info(), Eigen::NumericalIssue);
  EXPECT_FALSE(Ldlt<>(-MatrixXd::Identity(2, 2)).is_positive());
}

}  // namespace
}  // namespace abbe
