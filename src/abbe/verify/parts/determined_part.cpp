#include "abbe/verify/parts/determined_part.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/verify/covariance_root.h"
#include "abbe/verify/displacement_fields.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

// Part of the effect its errors can have on a machine of this size that a direction has to have, beside a rigid motion,
// to be called open. Errors of 1e-4 rad turn a rigid motion of the nominal machine into one that is not quite.
constexpr double kOpenPart = 1e-3;

}  // namespace

DeterminedPart determined_part(const Machine& machine, const ErrorSet& errors, const ParameterCovariance& covariance,
                               const Eigen::MatrixXd& unseen, const PoseList& poses, const ErrorMap& deviation) {
  const Index n = static_cast<Index>(covariance.parameters.size());
  if (covariance.covariance.rows() != n || covariance.covariance.cols() != n || unseen.rows() != n ||
      deviation.count() != poses.count() || poses.axis.size() != machine.axes.size()) {
    throw std::invalid_argument("determined part: covariance, directions, poses and deviations do not fit");
  }
  const DisplacementFields at = displacement_fields(machine, errors, covariance.parameters, poses, deviation.covered);
  const Index rows = at.by_parameter.rows();
  const Eigen::MatrixXd rigid = orthonormal_columns(at.by_motion, 1e-10);

  DeterminedPart part;
  Eigen::MatrixXd beside = at.by_parameter * unseen;
  remove_span(rigid, beside);
  // At every pose 1 mm for a millimetre, the size of the workspace for a radian.
  const std::vector<bool> is_angle = parameters_are_angles(machine, errors);
  Eigen::VectorXd effect(n);
  for (Index p = 0; p < n; ++p) {
    effect[p] = is_angle[covariance.parameters[static_cast<std::size_t>(p)]] ? at.size : 1;
  }
  const Eigen::VectorXd possible = std::sqrt(static_cast<double>(rows)) * (unseen.cwiseAbs().transpose() * effect);
  for (Index i = 0; i < unseen.cols(); ++i) {
    if (beside.col(i).norm() > kOpenPart * possible[i]) part.open_directions.push_back(static_cast<std::size_t>(i));
  }
  Eigen::MatrixXd open_columns(rows, static_cast<Index>(part.open_directions.size()));
  for (Index i = 0; i < open_columns.cols(); ++i) {
    const Index column = static_cast<Index>(part.open_directions[static_cast<std::size_t>(i)]);
    open_columns.col(i) = beside.col(column) / possible[column];
  }
  const Eigen::MatrixXd open = orthonormal_columns(open_columns, kOpenPart);
  part.open_rank = static_cast<std::size_t>(open.cols());

  Eigen::MatrixXd left(rows, 1);
  for (std::size_t k = 0; k < at.pose.size(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      left(static_cast<Index>(3 * k + c), 0) = deviation.displacement[c][at.pose[k]];
    }
  }
  remove_span(rigid, left);
  const Eigen::MatrixXd in_open = open * (open.transpose() * left);
  left -= in_open;
  Eigen::MatrixXd spread = at.by_parameter * covariance_root(covariance.covariance);
  remove_span(rigid, spread);
  remove_span(open, spread);
  for (std::size_t c = 0; c < 3; ++c) {
    for (auto* values : {&part.displacement[c], &part.uncertainty[c], &part.open[c]}) {
      values->assign(poses.count(), 0.0);
    }
    for (std::size_t k = 0; k < at.pose.size(); ++k) {
      const Index row = static_cast<Index>(3 * k + c);
      part.displacement[c][at.pose[k]] = left(row, 0);
      // A row of no columns has no place in memory.
      part.uncertainty[c][at.pose[k]] = spread.cols() > 0 ? spread.row(row).norm() : 0;
      part.open[c][at.pose[k]] = in_open(row, 0);
    }
  }
  return part;
}

}  // namespace abbe
