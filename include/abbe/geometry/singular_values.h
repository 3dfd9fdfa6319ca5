#pragma once

#include <Eigen/Core>

namespace abbe {

/// Right half of a singular value decomposition, A = U diag(values) V'.
struct RightSingular {
  Eigen::VectorXd values;   ///< [min(rows, columns)] not increasing, of the unit of A
  Eigen::MatrixXd vectors;  ///< [columns, columns] V; the columns beyond the rank span the null space
};

/// By one-sided Jacobi rotations after a pivoted QR, which keeps the zeros of a matrix of low rank at rounding.
///
/// Eigen's divide and conquer (BDCSVD, 3.4.0) is faster, but fails on matrices with many zero singular values: it loses
/// others, or its assertions stop it (the matrices of the test do that). Source: Demmel and Veselic, SIAM J. Matrix
/// Anal. Appl. 13 (1992) 1204.
RightSingular right_singular(const Eigen::MatrixXd& matrix);

}  // namespace abbe
