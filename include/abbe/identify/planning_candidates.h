#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "abbe/identify/problem.h"

namespace abbe {

/// Readings that could be taken, as rows of the whitened Jacobian, and what each costs.
struct PlanningCandidates {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  /// Rows of one candidate, at most.
  static constexpr std::size_t kMostRows = 16;

  Rows rows;  ///< [all rows, p]: d(modelled / standard uncertainty) / d(estimate), per mm or rad
  std::vector<std::size_t> first_row;  ///< [candidates + 1], increasing from 0
  std::vector<double> cost_s;          ///< [candidates] time of each, > 0; empty: every one costs 1

  std::size_t count() const { return first_row.empty() ? 0 : first_row.size() - 1; }
  double cost(std::size_t candidate) const { return cost_s.empty() ? 1 : cost_s[candidate]; }
};

/// Every used reading of a problem as a candidate: the rows of its whitened Jacobian at the present values, over the
/// vector of estimates, in order of observations and readings. No costs.
///
/// Build the observations from readings that could be taken; what they would read need not be known, only their
/// uncertainties (the noise model at the measured point).
/// @param threads  as for_each_block()
PlanningCandidates candidate_rows(const Problem& problem, int threads = 1);

}  // namespace abbe
