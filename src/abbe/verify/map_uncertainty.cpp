#include "abbe/verify/map_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/geometry/decompositions.h"
#include "abbe/verify/covariance_root.h"
#include "abbe/verify/parts/deviation_jacobian.h"

namespace abbe {
namespace {

using Motion = Eigen::Matrix<double, 3, 6>;

Motion displacement_by_motion(const DeviationBlock& block, std::size_t k) {
  return abbe::displacement_by_motion(block.seen[0][k], block.seen[1][k], block.seen[2][k]);
}

}  // namespace

MapUncertainty::MapUncertainty(const ParameterCovariance& covariance, std::size_t parameter_count, bool orientation)
    : parameters_(covariance.parameters), rows_(orientation ? 6 : 3) {
  const Eigen::Index n = static_cast<Eigen::Index>(parameters_.size());
  const Eigen::MatrixXd& c = covariance.covariance;
  if (c.rows() != n || c.cols() != n) throw std::invalid_argument("covariance does not have one row per parameter");
  for (std::size_t index : parameters_) {
    if (index >= parameter_count) throw std::invalid_argument("covariance of a parameter that is not there");
  }
  factor_ = covariance_root(c);
}

MapUncertainty::Sums MapUncertainty::no_sums() const {
  Sums sums;
  sums.mixed = Eigen::MatrixXd::Zero(6, static_cast<Eigen::Index>(parameters_.size()));
  return sums;
}

MapUncertainty::Sums MapUncertainty::sums(const DeviationModel& model, const DeviationBlock& block) const {
  Sums sums = no_sums();
  for_each_deviation_jacobian(model, block, parameters_, rows_,
                              [&](std::size_t from, Eigen::Index number, const Eigen::MatrixXd& jacobian) {
                                for (Eigen::Index k = 0; k < number; ++k) {
                                  const std::size_t pose = from + static_cast<std::size_t>(k);
                                  if (!block.covered[pose]) continue;
                                  const Motion b = displacement_by_motion(block, pose);
                                  sums.normal += b.transpose() * b;
                                  for (int c = 0; c < 3; ++c)
                                    sums.mixed += b.row(c).transpose() * jacobian.row(c * number + k);
                                }
                              });
  return sums;
}

void MapUncertainty::remove_rigid_motion(const Sums& total) {
  // Poses on one line leave a rotation open; the shortest solution removes nothing there.
  removed_ = CompleteOrthogonal(total.normal).solve_columns(total.mixed);
}

void MapUncertainty::evaluate(const DeviationModel& model, const DeviationBlock& block,
                              std::array<std::vector<double>, 6>& uncertainty,
                              std::vector<double>& norm_uncertainty) const {
  for (Eigen::Index c = 0; c < rows_; ++c) uncertainty[static_cast<std::size_t>(c)].resize(block.count);
  norm_uncertainty.resize(block.count);
  Eigen::MatrixXd removed_factor;
  if (removed_.size() > 0) removed_factor = removed_ * factor_;
  for_each_deviation_jacobian(
      model, block, parameters_, rows_, [&](std::size_t from, Eigen::Index number, const Eigen::MatrixXd& jacobian) {
        Eigen::MatrixXd spread = jacobian.topRows(rows_ * number) * factor_;
        for (Eigen::Index k = 0; k < number; ++k) {
          const std::size_t pose = from + static_cast<std::size_t>(k);
          if (removed_.size() > 0) {
            const Eigen::MatrixXd moved = displacement_by_motion(block, pose) * removed_factor;
            for (int c = 0; c < 3; ++c) spread.row(c * number + k) -= moved.row(c);
            for (int c = 3; c < rows_; ++c) spread.row(c * number + k) -= removed_factor.row(c);
          }
          Eigen::Matrix3d covariance;
          for (int i = 0; i < 3; ++i) {
            for (int j = i; j < 3; ++j) {
              covariance(i, j) = covariance(j, i) = spread.row(i * number + k).dot(spread.row(j * number + k));
            }
          }
          for (int c = 0; c < rows_; ++c) {
            const double variance = c < 3 ? covariance(c, c) : spread.row(c * number + k).squaredNorm();
            uncertainty[static_cast<std::size_t>(c)][pose] = std::sqrt(variance);
          }
          double along = 0;
          if (block.norm[pose] > 0) {
            const Eigen::Vector3d direction =
                Eigen::Vector3d(block.displacement[0][pose], block.displacement[1][pose], block.displacement[2][pose]) /
                block.norm[pose];
            along = direction.dot(covariance * direction);
          } else {
            along = SymmetricEigen<3>(covariance, Eigen::EigenvaluesOnly).eigenvalues()[2];
          }
          norm_uncertainty[pose] = std::sqrt(std::max(0.0, along));
        }
      });
}

}  // namespace abbe
