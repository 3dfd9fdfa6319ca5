#include "abbe/verify/determined_part.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/verify/covariance_root.h"
#include "abbe/verify/deviation_block.h"
#include "abbe/verify/deviation_jacobian.h"

namespace abbe {
namespace {

using Index = Eigen::Index;

// Part of the effect its errors can have on a machine of this size that a direction has to have, beside a rigid motion,
// to be called open. Errors of 1e-4 rad turn a rigid motion of the nominal machine into one that is not quite.
constexpr double kOpenPart = 1e-3;

/// Orthonormal columns that span those of `columns`, which have comparable lengths.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& columns, double threshold) {
  if (columns.cols() == 0) return columns;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  qr.setThreshold(threshold);
  return qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), qr.rank());
}

void remove(const Eigen::MatrixXd& span, Eigen::MatrixXd& from) {
  if (span.cols() > 0) from -= span * (span.transpose() * from).eval();
}

/// Displacements at the covered poses, three rows each.
struct Displacements {
  std::vector<std::size_t> pose;
  Eigen::MatrixXd by_parameter;  ///< [3 poses, n]
  Eigen::MatrixXd by_motion;     ///< [3 poses, 6], columns of length 1 at most
  double size = 0;               ///< root mean square distance of the points from their middle, mm
};

Displacements displacements(const Machine& machine, const ErrorSet& errors, const ParameterCovariance& covariance,
                            const PoseSource& poses, const std::vector<std::uint8_t>& wanted) {
  Displacements result;
  const DeviationModel model(machine, errors, nullptr, false);
  std::vector<Eigen::Vector3d> points;
  const Index n = static_cast<Index>(covariance.parameters.size());
  result.by_parameter.resize(3 * std::count(wanted.begin(), wanted.end(), std::uint8_t{1}), n);
  Index row = 0;
  DeviationBlock block;
  for (std::size_t index = 0; index < block_count(poses); ++index) {
    load_block(poses, index, block);
    model.evaluate(block, {});
    for_each_deviation_jacobian(model, block, covariance.parameters, 3,
                                [&](std::size_t from, Index number, const Eigen::MatrixXd& jacobian) {
                                  for (Index k = 0; k < number; ++k) {
                                    const std::size_t at = from + static_cast<std::size_t>(k);
                                    if (wanted[block.first + at] == 0) continue;
                                    result.pose.push_back(block.first + at);
                                    points.emplace_back(block.seen[0][at], block.seen[1][at], block.seen[2][at]);
                                    for (Index c = 0; c < 3; ++c)
                                      result.by_parameter.row(row++) = jacobian.row(c * number + k);
                                  }
                                });
  }
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) centre += point / static_cast<double>(points.size());
  result.by_motion.resize(row, 6);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector3d p = points[k] - centre;
    result.size += p.squaredNorm() / static_cast<double>(points.size());
    result.by_motion.middleRows(3 * static_cast<Index>(k), 3) = displacement_by_motion(p[0], p[1], p[2]);
  }
  result.size = std::sqrt(result.size);
  const double largest = points.empty() ? 1 : result.by_motion.rightCols(3).colwise().norm().maxCoeff();
  if (largest > 0) result.by_motion.rightCols(3) /= largest;
  result.by_motion.leftCols(3) /= std::sqrt(std::max(1.0, static_cast<double>(points.size())));
  return result;
}

}  // namespace

DeterminedPart determined_part(const Machine& machine, const ErrorSet& errors, const ParameterCovariance& covariance,
                               const Eigen::MatrixXd& unseen, const PoseSource& poses, const ErrorMap& deviation) {
  const Index n = static_cast<Index>(covariance.parameters.size());
  if (covariance.covariance.rows() != n || covariance.covariance.cols() != n || unseen.rows() != n ||
      deviation.count() != poses.count || poses.axes != machine.axes.size()) {
    throw std::invalid_argument("determined part: covariance, directions, poses and deviations do not fit");
  }
  const Displacements at = displacements(machine, errors, covariance, poses, deviation.covered);
  const Index rows = at.by_parameter.rows();
  const Eigen::MatrixXd rigid = orthonormal(at.by_motion, 1e-10);

  DeterminedPart part;
  Eigen::MatrixXd beside = at.by_parameter * unseen;
  remove(rigid, beside);
  // At every pose 1 mm for a millimetre, the size of the workspace for a radian.
  const std::vector<bool> is_angle = parameters_are_angles(errors);
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
  const Eigen::MatrixXd open = orthonormal(open_columns, kOpenPart);
  part.open_rank = static_cast<std::size_t>(open.cols());

  Eigen::MatrixXd left(rows, 1);
  for (std::size_t k = 0; k < at.pose.size(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      left(static_cast<Index>(3 * k + c), 0) = deviation.displacement[c][at.pose[k]];
    }
  }
  remove(rigid, left);
  const Eigen::MatrixXd in_open = open * (open.transpose() * left);
  left -= in_open;
  Eigen::MatrixXd spread = at.by_parameter * covariance_root(covariance.covariance);
  remove(rigid, spread);
  remove(open, spread);
  for (std::size_t c = 0; c < 3; ++c) {
    for (auto* values : {&part.displacement[c], &part.uncertainty[c], &part.open[c]}) {
      values->assign(poses.count, 0.0);
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
