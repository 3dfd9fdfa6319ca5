#include "abbe/identify/trust/shown_by.h"

#include <algorithm>
#include <cmath>

#include "abbe/geometry/singular_values.h"
#include "abbe/identify/measurements_together.h"
#include "abbe/identify/normal_equations.h"

namespace abbe {
namespace {

using Eigen::Index;

/// Directions that the readings of a problem leave open, in parameters of typical size: orthonormal columns.
Eigen::MatrixXd open_directions(const Problem& problem, const Eigen::VectorXd& typical, int threads) {
  Eigen::VectorXd nominal = present_values(problem);
  const std::vector<EstimatedParameter> parameters = estimated_parameters(problem);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].id.is_machine()) nominal[static_cast<Index>(i)] = 0;
  }
  const ReadingStream stream(problem, threads);
  const Eigen::MatrixXd factor = stream.orthogonal_factor(nominal, Loss{}) * typical.asDiagonal();
  const RightSingular svd = right_singular(factor);
  const double limit = still_unseen(factor.norm());
  Index rank = 0;
  while (rank < svd.values.size() && svd.values[rank] > limit) ++rank;
  return svd.vectors.rightCols(typical.size() - rank);
}

/// Largest part of the columns that lies in a space, relative to them.
double part_in(const Eigen::MatrixXd& space, const Eigen::MatrixXd& directions) {
  double largest = 0;
  for (Index i = 0; i < directions.cols(); ++i) {
    const double length = directions.col(i).norm();
    if (length > 0 && space.cols() > 0)
      largest = std::max(largest, (space.transpose() * directions.col(i)).norm() / length);
  }
  return largest;
}

}  // namespace

std::vector<ShownBy> shown_by(const Problem& problem, const std::vector<std::vector<std::size_t>>& groups,
                              const std::vector<PossibleMeasurement>& possible, const AdviceOptions& options,
                              int threads) {
  const Eigen::VectorXd typical = typical_sizes(estimated_parameters(problem), options);
  const Index p = typical.size();
  const Eigen::MatrixXd open = open_directions(problem, typical, threads);
  std::vector<Eigen::MatrixXd> rows, left;
  Eigen::MatrixXd never = open;
  for (const PossibleMeasurement& measurement : possible) {
    rows.emplace_back(rows_without_own(measurement, p) * typical.asDiagonal());
    left.push_back(left_open(rows.back(), open));
    never = left_open(rows.back(), never);
  }
  std::vector<ShownBy> result;
  for (const std::vector<std::size_t>& group : groups) {
    ShownBy shown;
    Eigen::MatrixXd asked = Eigen::MatrixXd::Zero(p, static_cast<Index>(group.size()));
    for (std::size_t i = 0; i < group.size(); ++i) asked(static_cast<Index>(group[i]), static_cast<Index>(i)) = 1;
    Eigen::MatrixXd unseen = open * (open.transpose() * asked);
    unseen -= never * (never.transpose() * unseen).eval();
    // What is seen well enough of a direction is not asked about any more.
    for (Index i = 0; i < unseen.cols(); ++i) {
      if (unseen.col(i).norm() <= kLeftUnseen) unseen.col(i).setZero();
    }
    const bool nothing_shows = part_in(never, asked) > std::sqrt(1 - kLeftUnseen * kLeftUnseen);
    if (unseen.isZero(0)) {
      shown.by_readings = shown.shown = !nothing_shows;
      result.push_back(shown);
      continue;
    }
    for (std::size_t k = 0; k < possible.size() && !shown.shown; ++k) {
      if (part_in(left[k], unseen) > kLeftUnseen) continue;
      shown.shown = true;
      shown.remedy = clause_of(possible[k]);
    }
    if (!shown.shown) {
      const MeasurementsTogether together = measurements_together(possible, rows, open, unseen);
      shown.shown = together.enough;
      shown.remedy = together.enough ? together.words : "only several of the measurements tried, together";
    }
    result.push_back(shown);
  }
  return result;
}

}  // namespace abbe
