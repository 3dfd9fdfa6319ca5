#pragma once

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

#include "identification_timing.h"

namespace abbe::benchmarks {

struct CeresSolution {
  double time = 0;         ///< s, covariance included
  double solver_time = 0;  ///< s, without it
  Eigen::VectorXd x;
  Eigen::VectorXd uncertainty;
  int iterations = 0;
  bool converged = false;
};

/// The tolerances that our_options() has too.
inline ceres::Solver::Options ceres_options() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.num_threads = kThreads;
  options.function_tolerance = 1e-12;
  options.gradient_tolerance = 1e-10;
  options.parameter_tolerance = 1e-11;
  options.max_num_iterations = 50;
  return options;
}

/// Solves, then takes the covariance from the Jacobian at the solution in the cheapest way Ceres offers: one
/// evaluation, J'J by Eigen.
/// @param x       memory of all parameter blocks, in the order of `blocks`
/// @param blocks  the problem's parameter blocks
inline CeresSolution solve_with_covariance(ceres::Problem& problem, const Eigen::VectorXd& x,
                                           const std::vector<double*>& blocks) {
  CeresSolution result;
  ceres::Solver::Summary summary;
  const double start = seconds();
  ceres::Solve(ceres_options(), &problem, &summary);
  result.solver_time = seconds() - start;
  ceres::Problem::EvaluateOptions evaluate;
  evaluate.num_threads = kThreads;
  evaluate.parameter_blocks = blocks;
  ceres::CRSMatrix crs;
  problem.Evaluate(evaluate, nullptr, nullptr, nullptr, &crs);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(crs.num_cols, crs.num_cols);
  // The Jacobian is sparse where a residual does not see all blocks: spread out some rows at a time.
  constexpr int kRows = 1024;
  Eigen::MatrixXd rows(crs.num_cols, kRows);
  for (int first = 0; first < crs.num_rows; first += kRows) {
    const int count = std::min(kRows, crs.num_rows - first);
    rows.setZero();
    for (int row = 0; row < count; ++row) {
      const std::size_t at = static_cast<std::size_t>(first + row);
      for (std::size_t k = static_cast<std::size_t>(crs.rows[at]); k < static_cast<std::size_t>(crs.rows[at + 1]); ++k)
        rows(crs.cols[k], row) = crs.values[k];
    }
    normal.selfadjointView<Eigen::Lower>().rankUpdate(rows);
  }
  const Eigen::MatrixXd covariance =
      normal.selfadjointView<Eigen::Lower>().llt().solve(Eigen::MatrixXd::Identity(crs.num_cols, crs.num_cols));
  result.time = seconds() - start;
  result.uncertainty = covariance.diagonal().cwiseSqrt();
  result.x = x;
  result.iterations = static_cast<int>(summary.iterations.size());
  result.converged = summary.termination_type == ceres::CONVERGENCE;
  return result;
}

}  // namespace abbe::benchmarks
