#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "abbe/geometry/work_in_step.h"
#include "abbe/identify/planning_candidates.h"

namespace abbe {

/// Everything that some candidate, or what is known already, can see, and the candidates in coordinates of it.
///
/// Directions of the estimates that nothing sees (the gauge of all candidates together) are left out, so that a model
/// with such directions still has a plan for the rest. With the column-scaled rows J D^-1 = U S V', the seen part
/// y = S1 V1' D x has coordinates in which all candidates measured once, with what is known, have the unit matrix as
/// information: a direction that is hardly seen is one like any other. What a choice of readings does not determine
/// within the seen part is never hidden; see PlanValue.
class PlanningSpace {
 public:
  /// @param known      [rows, p] priors and readings taken already, or without rows
  /// @param threshold  singular values of the scaled rows below this part of the largest are not seen
  /// @throws std::invalid_argument for sizes that do not agree, costs not above zero, or numbers that are not finite
  PlanningSpace(const PlanningCandidates& candidates, const Eigen::MatrixXd& known, double threshold = 1e-11)
      : PlanningSpace(candidates, known, WorkInStep(), 1, threshold) {}
  /// @param in_step  processes that make the same space, which then share the work
  /// @param threads  of this process, as for_each_block()
  PlanningSpace(const PlanningCandidates& candidates, const Eigen::MatrixXd& known, const WorkInStep& in_step,
                int threads, double threshold = 1e-11);

  std::size_t count() const { return first_row_.size() - 1; }
  std::size_t parameter_count() const { return static_cast<std::size_t>(estimates_from_seen_.rows()); }
  /// v, number of seen directions.
  std::size_t dimension() const { return static_cast<std::size_t>(estimates_from_seen_.cols()); }
  /// [p] of the scaled rows, decreasing, relative to the largest.
  const Eigen::VectorXd& singular_values() const { return singular_values_; }
  /// Singular values of a choice in seen coordinates, relative to the largest, must be above this to be more than
  /// rounding: a direction that is hardly seen has few digits.
  double determined() const { return determined_; }
  /// B, [p, v]: estimates x = B y, the smallest in scaled parameters.
  const Eigen::MatrixXd& estimates_from_seen() const { return estimates_from_seen_; }
  /// [p, p - v] directions that nothing sees, orthonormal in scaled parameters.
  const Eigen::MatrixXd& unseen() const { return unseen_; }

  /// Functionals of the estimates as functionals of the seen part, [rows, v].
  Eigen::MatrixXd functionals(const Eigen::MatrixXd& rows) const;
  /// Largest part of a functional's length (in scaled parameters) that lies in unseen directions, [rows], 0 to 1.
  Eigen::VectorXd unseen_part(const Eigen::MatrixXd& rows) const;

  std::size_t first_row(std::size_t candidate) const { return first_row_[candidate]; }
  std::size_t row_count(std::size_t candidate) const { return first_row_[candidate + 1] - first_row_[candidate]; }
  /// Row of the candidates in seen coordinates, [stride()], zeros behind the v-th.
  const double* row(std::size_t index) const { return rows_.data() + index * stride_; }
  std::size_t stride() const { return stride_; }
  double cost(std::size_t candidate) const { return cost_s_.empty() ? 1 : cost_s_[candidate]; }
  bool has_costs() const { return !cost_s_.empty(); }
  /// R'R, [v, v]: information of what is known already, in seen coordinates.
  const Eigen::MatrixXd& known_information() const { return known_information_; }
  /// [rows, v]
  const Eigen::MatrixXd& known_rows() const { return known_rows_; }

 private:
  std::vector<std::size_t> first_row_;
  std::vector<double> cost_s_;
  std::vector<double> rows_;
  std::size_t stride_ = 0;
  double determined_ = 0;
  Eigen::VectorXd singular_values_;
  Eigen::VectorXd column_norms_;
  Eigen::MatrixXd estimates_from_seen_;
  Eigen::MatrixXd unseen_;
  Eigen::MatrixXd known_rows_;
  Eigen::MatrixXd known_information_;
};

/// What a choice of readings is worth.
struct PlanValue {
  std::size_t rank = 0;        ///< of the seen directions, how many the choice determines
  bool determined = false;     ///< rank is the dimension of the space; only then the rest means anything
  double log_determinant = 0;  ///< of the information, relative to all candidates measured once: at most 0
  double variance = 0;         ///< sum of the functionals' variances, unit of the functional squared
  double cost = 0;             ///< s, or number of readings
};

/// Value of any choice (with repetitions), by an orthogonal factorisation of its rows: a direction counts as determined
/// if its singular value is above PlanningSpace::determined() of the largest.
/// @param functionals  [m, p] of the estimates, or without rows
PlanValue value_of(const PlanningSpace& space, std::span<const std::size_t> chosen, const Eigen::MatrixXd& functionals);

/// Value of readings that are no candidates, all of them taken once, within the same seen directions. What they see
/// beyond these is not counted.
PlanValue value_of(const PlanningSpace& space, const PlanningCandidates& others, const Eigen::MatrixXd& functionals);

/// Covariance of the estimates from a choice, [p, p], in the gauge of smallest scaled parameters; empty if the choice
/// does not determine all that the space sees.
Eigen::MatrixXd planned_covariance(const PlanningSpace& space, std::span<const std::size_t> chosen);

}  // namespace abbe
