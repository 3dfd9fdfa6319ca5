#pragma once

// Internal to plan: sums, factor and products of the rows of all candidates, computed in blocks by threads and
// processes.
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/work_in_step.h"
#include "abbe/identify/planning_candidates.h"

namespace abbe {

/// Factor R of rows that are added one by one and not kept.
class StreamingFactor {
 public:
  explicit StreamingFactor(Eigen::Index columns)
      : columns_(columns), work_(Eigen::MatrixXd::Zero(columns + kRowsBetweenReductions, columns)) {}
  /// The row to be written next; valid until add().
  auto next() { return work_.row(columns_ + filled_); }
  void add() {
    if (++filled_ == kRowsBetweenReductions) reduce();
  }
  /// [columns, columns], upper triangular
  Eigen::MatrixXd factor() {
    reduce();
    return work_.topRows(columns_);
  }

 private:
  static constexpr Eigen::Index kRowsBetweenReductions = 512;

  void reduce() {
    if (filled_ == 0) return;
    Qr::in_place(work_);
    for (Eigen::Index j = 0; j < columns_; ++j) work_.col(j).tail(work_.rows() - j - 1).setZero();
    filled_ = 0;
  }

  Eigen::Index columns_;
  Eigen::Index filled_ = 0;
  Eigen::MatrixXd work_;
};

/// The processes and threads that share the work. The results have the same bytes for any number of them.
struct SharedRows {
  const WorkInStep& in_step;
  int threads;  ///< of this process, as for_each_block()
};

/// Sums of squares, [columns]. Every process computes them from all rows: they become part of the fingerprint that
/// tells other candidates apart.
Eigen::VectorXd squares_of_columns(const PlanningCandidates::Rows& rows, int threads);

/// Factor R of the known rows and all others, each column times its scale, [columns, columns].
Eigen::MatrixXd factor_of_rows(const PlanningCandidates::Rows& rows, const Eigen::MatrixXd& known,
                               const Eigen::VectorXd& scale, const SharedRows& shared);

/// rows * factor, row by row, `stride` apart, with zeros behind each row and some rows of zeros behind the last one.
/// @param stride  not below the columns of the factor, padded (cross_products.h)
std::vector<double> multiply_rows(const PlanningCandidates::Rows& rows, const Eigen::MatrixXd& factor,
                                  const SharedRows& shared, std::size_t stride);

}  // namespace abbe
