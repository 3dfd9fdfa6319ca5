#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <complex>
#include <type_traits>

namespace abbe {

/// Decompositions of matrices, compiled once.
///
///     const SymmetricEigen<3> principal(scatter);             // eigenvalues ascending
///     const Eigen::Vector3d normal = principal.eigenvectors().col(0);
///     const Eigen::VectorXd x = PivotedQr(a).solve(b);        // least squares
///
/// Each class below is Eigen's decomposition of the same purpose, whose code is long: a source file that instantiates
/// it takes 3 to 15 s longer to compile. Here only what the library uses is declared, and the code stands in
/// decompositions_*.cpp. A fixed size N is that of the matrices; most are decomposed by the code for any size, which
/// gives the same bits (decompositions_test.cpp). Nothing throws; a matrix with a number that is not finite gives
/// results that are not finite.

/// Eigenvalues, ascending, and orthonormal eigenvectors of a symmetric matrix, of which the lower half is read.
template <int N = Eigen::Dynamic>
class SymmetricEigen {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;
  /// @param options  Eigen::EigenvaluesOnly: the eigenvectors are not wanted
  explicit SymmetricEigen(const Matrix& matrix, int options = Eigen::ComputeEigenvectors);
  Eigen::ComputationInfo info() const { return info_; }
  const Vector& eigenvalues() const { return values_; }    ///< [N]
  const Matrix& eigenvectors() const { return vectors_; }  ///< [N, N], a column each

 private:
  Vector values_;
  Matrix vectors_;
  Eigen::ComputationInfo info_;
};
extern template class SymmetricEigen<2>;
extern template class SymmetricEigen<3>;
extern template class SymmetricEigen<5>;
extern template class SymmetricEigen<6>;
extern template class SymmetricEigen<Eigen::Dynamic>;

/// Cholesky factor without roots, A = P'LDL'P, of a symmetric matrix that may be semi-definite or indefinite.
template <int N = Eigen::Dynamic>
class Ldlt {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;
  explicit Ldlt(const Matrix& matrix);
  Eigen::ComputationInfo info() const { return factor_.info(); }
  bool is_positive() const { return factor_.isPositive(); }
  Vector diagonal() const { return factor_.vectorD(); }  ///< D, [N]
  Vector solve(const Vector& right) const;
  Eigen::MatrixXd solve_columns(const Eigen::MatrixXd& right) const;

 private:
  Eigen::LDLT<Eigen::MatrixXd> factor_;
};
extern template class Ldlt<5>;
extern template class Ldlt<6>;
extern template class Ldlt<Eigen::Dynamic>;

/// Cholesky factor A = LL' of a symmetric, positive definite matrix, of which the lower half is read.
class Cholesky {
 public:
  Cholesky() = default;
  explicit Cholesky(const Eigen::MatrixXd& matrix) { compute(matrix); }
  void compute(const Eigen::MatrixXd& matrix);
  /// Eigen::NumericalIssue: the matrix is not positive definite.
  Eigen::ComputationInfo info() const { return factor_.info(); }
  Eigen::VectorXd diagonal() const { return factor_.matrixLLT().diagonal(); }  ///< of L
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
  Eigen::MatrixXd solve_columns(const Eigen::MatrixXd& right) const;
  Eigen::MatrixXd half_solve(const Eigen::MatrixXd& right) const;  ///< L^-1 right

 private:
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

/// A = QR by Householder reflections, without pivoting.
class Qr {
 public:
  explicit Qr(const Eigen::MatrixXd& matrix);
  Eigen::MatrixXd upper(Eigen::Index rows) const;                         ///< first rows of R, zero below the diagonal
  Eigen::MatrixXd orthonormal(Eigen::Index count) const;                  ///< first columns of Q
  Eigen::MatrixXd rotated(const Eigen::MatrixXd& right) const;            ///< Q right
  Eigen::MatrixXd rotated_from_right(const Eigen::MatrixXd& left) const;  ///< left Q
  Eigen::VectorXd rotated_back(const Eigen::VectorXd& right) const;       ///< Q' right
  /// Replaces the matrix by R above its diagonal; what stands below it is left over from the decomposition.
  static void in_place(Eigen::MatrixXd& matrix);

 private:
  Eigen::HouseholderQR<Eigen::MatrixXd> factors_;
};

/// A P = QR by Householder reflections with exchange of columns: least squares and rank.
class PivotedQr {
 public:
  explicit PivotedQr(const Eigen::MatrixXd& matrix);
  void set_threshold(double threshold) { factors_.setThreshold(threshold); }  ///< relative to the largest pivot
  Eigen::Index rank() const { return factors_.rank(); }
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
  Eigen::MatrixXd upper(Eigen::Index rows) const;         ///< first rows of R, zero below the diagonal
  Eigen::MatrixXd orthonormal(Eigen::Index count) const;  ///< first columns of Q
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd>::PermutationType& columns() const {
    return factors_.colsPermutation();  ///< P
  }

 private:
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors_;
};

/// Shortest least-squares solution where columns may depend on each other.
class CompleteOrthogonal {
 public:
  /// @param threshold  of the pivots, relative to the largest; negative: that of rounding
  explicit CompleteOrthogonal(const Eigen::MatrixXd& matrix, double threshold = -1);
  Eigen::Index rank() const { return factors_.rank(); }
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
  Eigen::MatrixXd solve_columns(const Eigen::MatrixXd& right) const;
  Eigen::MatrixXd pseudo_inverse() const;

 private:
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors_;
};

/// P A Q = LU with exchange of rows and columns.
template <int N = Eigen::Dynamic>
class FullLu {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;
  explicit FullLu(const Matrix& matrix);
  void set_threshold(double threshold) { factors_.setThreshold(threshold); }  ///< relative to the largest pivot
  Eigen::Index rank() const { return factors_.rank(); }
  Eigen::Index kernel_dimension() const { return factors_.dimensionOfKernel(); }
  double reciprocal_condition() const;  ///< of an invertible matrix
  /// The least pivot against the largest: zero, or rounding, of a singular matrix.
  double pivot_ratio() const { return std::abs(factors_.matrixLU().diagonal().tail(1)[0]) / factors_.maxPivot(); }
  Vector solve(const Vector& right) const;
  Matrix inverse() const;
  Eigen::MatrixXd kernel() const;  ///< a column each; one of zeros where there is none
  /// As if so many of the last pivots were zero: those vectors, a column each.
  Eigen::MatrixXd kernel_of(Eigen::Index dimension) const;
  Eigen::VectorXi columns() const { return factors_.permutationQ().indices(); }  ///< Q

 private:
  // Six and twelve rows have code of their own, whose sums have another order and which does not allocate.
  using Factored = std::conditional_t<N == 6 || N == 12, Matrix, Eigen::MatrixXd>;
  Eigen::FullPivLU<Factored> factors_;
};
extern template class FullLu<3>;
extern template class FullLu<6>;
extern template class FullLu<12>;
extern template class FullLu<Eigen::Dynamic>;

/// P A = LU with exchange of rows, of an invertible matrix.
class PartialLu {
 public:
  explicit PartialLu(const Eigen::MatrixXd& matrix);
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
  Eigen::MatrixXd solve_columns(const Eigen::MatrixXd& right) const;
  Eigen::MatrixXd inverse() const;

 private:
  Eigen::PartialPivLU<Eigen::MatrixXd> factors_;
};

/// A = U diag(values) V' by Jacobi rotations, all columns of U and V; values not increasing.
template <int N = Eigen::Dynamic>
class SingularValues {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;
  explicit SingularValues(const Matrix& matrix, unsigned int options = Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector& values() const { return values_; }
  const Matrix& u() const { return u_; }
  const Matrix& v() const { return v_; }

 private:
  Vector values_;
  Matrix u_, v_;
};
extern template class SingularValues<3>;
extern template class SingularValues<Eigen::Dynamic>;

/// Eigenvalues of any square matrix, in no order. Does not allocate.
template <int N>
class GeneralEigenvalues {
 public:
  explicit GeneralEigenvalues(const Eigen::Matrix<double, N, N>& matrix);
  Eigen::ComputationInfo info() const { return info_; }
  const Eigen::Matrix<std::complex<double>, N, 1>& values() const { return values_; }

 private:
  Eigen::Matrix<std::complex<double>, N, 1> values_;
  Eigen::ComputationInfo info_;
};
extern template class GeneralEigenvalues<24>;

/// Eigenvalues of any square matrix, in no order, with a vector each, as columns.
class GeneralEigenvectors {
 public:
  explicit GeneralEigenvectors(const Eigen::MatrixXd& matrix);
  Eigen::ComputationInfo info() const { return info_; }
  const Eigen::VectorXcd& values() const { return values_; }
  const Eigen::MatrixXcd& vectors() const { return vectors_; }

 private:
  Eigen::VectorXcd values_;
  Eigen::MatrixXcd vectors_;
  Eigen::ComputationInfo info_;
};

}  // namespace abbe
