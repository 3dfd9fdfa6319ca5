#pragma once

#include <memory>
#include <vector>

#include "ceres_solution.h"
#include "five_instruments_case.h"

namespace abbe::benchmarks {

enum class CeresDerivatives {
  whole,   ///< AutoDiffCostFunction: all derivatives of a reading in one pass, sizes known at compile time
  strides  ///< DynamicAutoDiffCostFunction: four derivatives at a time
};

/// The problem of FiveInstrumentsCase as a user of Ceres writes it: one residual block per reading, parameter blocks
/// per axis and set-up so that a reading has only those it needs, automatic differentiation.
class CeresIdentification {
 public:
  /// @param problem  of `data`, at the start; both must outlive this
  CeresIdentification(const benchmark_case::FiveInstrumentsCase& data, const Problem& problem, CeresDerivatives);

  /// At the start: readings in the order of the instruments, the rows of one reading next to each other; no priors.
  std::vector<double> residuals();
  CeresSolution solve() { return solve_with_covariance(ceres_, x_, blocks_); }

 private:
  void add_prior(const Problem& problem, std::size_t block);

  Eigen::VectorXd x_;
  std::vector<double*> blocks_;
  std::vector<std::size_t> sizes_;
  std::vector<ceres::ResidualBlockId> readings_;
  ceres::Problem ceres_;
};

}  // namespace abbe::benchmarks
