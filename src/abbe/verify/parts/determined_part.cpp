#include "abbe/verify/parts/determined_part.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "abbe/verify/covariance_root.h"
#include "abbe/verify/displacement_fields.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

// Part of the effect its errors can have on a machine of this size that a direction has to have, beside a rigid motion,
// to be called open. Errors of 1e-4 rad turn a rigid motion of the nominal machine into one that is not quite.
constexpr double kOpenPart = 1e-3;
// A parameter with less than this part of the effect of a direction is rounding in it.
constexpr double kNoPart = 1e-9;

/// Effect of a unit of each parameter at every pose: 1 mm for a millimetre, the size of the workspace for a radian.
Eigen::VectorXd effects(const Machine& machine, const ErrorSet& errors, const std::vector<std::size_t>& parameters,
                        double size) {
  const std::vector<bool> is_angle = parameters_are_angles(machine, errors);
  Eigen::VectorXd effect(static_cast<Index>(parameters.size()));
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    effect[static_cast<Index>(p)] = is_angle[parameters[p]] ? size : 1;
  }
  return effect;
}

/// The unseen directions that are open, and an orthonormal basis of their displacements.
struct OpenPart {
  std::vector<std::size_t> directions;
  Eigen::MatrixXd basis;  ///< [3 poses, rank]
};

/// @param rigid   orthonormal displacements by rigid motions
/// @param beside  displacements by the unseen directions
/// @param effect  of a unit of each parameter
OpenPart open_part(const Eigen::MatrixXd& rigid, Eigen::MatrixXd beside, const Eigen::MatrixXd& unseen,
                   const Eigen::VectorXd& effect) {
  remove_span(rigid, beside);
  const Index rows = beside.rows();
  const Eigen::VectorXd possible = std::sqrt(static_cast<double>(rows)) * (unseen.cwiseAbs().transpose() * effect);
  OpenPart part;
  for (Index i = 0; i < unseen.cols(); ++i) {
    if (beside.col(i).norm() > kOpenPart * possible[i]) part.directions.push_back(static_cast<std::size_t>(i));
  }
  Eigen::MatrixXd columns(rows, static_cast<Index>(part.directions.size()));
  for (Index i = 0; i < columns.cols(); ++i) {
    const Index column = static_cast<Index>(part.directions[static_cast<std::size_t>(i)]);
    columns.col(i) = beside.col(column) / possible[column];
  }
  part.basis = orthonormal_columns(columns, kOpenPart);
  return part;
}

/// Which parameters the directions consist of.
std::vector<std::size_t> parts_of(const Eigen::MatrixXd& unseen, const Eigen::VectorXd& effect) {
  const Eigen::MatrixXd parts = effect.asDiagonal() * unseen.cwiseAbs();
  const Eigen::RowVectorXd least = kNoPart * parts.colwise().sum();
  std::vector<std::size_t> found;
  for (Index p = 0; p < parts.rows(); ++p) {
    if ((parts.row(p).array() > least.array()).any()) found.push_back(static_cast<std::size_t>(p));
  }
  return found;
}

}  // namespace

OpenDirections open_directions(const Machine& machine, const ErrorSet& errors,
                               const std::vector<std::size_t>& parameters, const Eigen::MatrixXd& unseen,
                               const PoseList& poses, const std::vector<std::uint8_t>& covered) {
  if (unseen.rows() != static_cast<Index>(parameters.size())) {
    throw std::invalid_argument("open directions: parameters and directions do not fit");
  }
  const std::vector<std::size_t> parts = parts_of(unseen, effects(machine, errors, parameters, 1));
  if (parts.empty()) return {};
  std::vector<std::size_t> used;
  Eigen::MatrixXd directions(static_cast<Index>(parts.size()), unseen.cols());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    used.push_back(parameters[parts[p]]);
    directions.row(static_cast<Index>(p)) = unseen.row(static_cast<Index>(parts[p]));
  }
  const DisplacementFields at = displacement_fields(machine, errors, used, poses, covered);
  OpenPart part = open_part(orthonormal_columns(at.by_motion, 1e-10), at.by_parameter * directions, directions,
                            effects(machine, errors, used, at.size));
  return {std::move(part.directions), static_cast<std::size_t>(part.basis.cols())};
}

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

  OpenPart found =
      open_part(rigid, at.by_parameter * unseen, unseen, effects(machine, errors, covariance.parameters, at.size));
  const Eigen::MatrixXd& open = found.basis;
  DeterminedPart part;
  part.open_directions = std::move(found.directions);
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
