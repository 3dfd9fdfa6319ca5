#include "abbe/identify/sums/pose_sums.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace abbe {
namespace {

using Index = Eigen::Index;
constexpr std::size_t kMostPosePieces = 48;
constexpr std::size_t kPosesTogether = 64;  // their rows make one matrix product

/// Residuals and Jacobian of the readings of one pose: adds up what they do along the directions of z.
class PoseRows {
 public:
  PoseRows(const SelectedObservations& selected, const std::vector<std::size_t>& machine, const PoseGroups& poses)
      : selected_(selected), machine_(machine), poses_(poses), columns_(machine_.size() + selected_.unknowns.size()) {}

  /// @param along  out, z'J as columns of [columns, 3], and z'r
  /// @return r'r
  double add(const PoseGroups::Group& group, Eigen::Ref<Eigen::MatrixXd> along, Eigen::Vector3d& along_residual) {
    const std::size_t rows = poses_.rows();
    double square = 0;
    along.setZero();
    along_residual.setZero();
    for (std::size_t begin = 0; begin < group.readings.size();) {
      std::size_t end = begin + 1;
      while (end < group.readings.size() && end - begin < Observations::kBlockSize &&
             group.readings[end] == group.readings[end - 1] + 1)
        ++end;
      const std::size_t n = end - begin;
      residuals_.resize(static_cast<Index>(rows * n));
      jacobian_.resize(static_cast<Index>(rows * n), static_cast<Index>(columns_));
      selected_.observations->evaluate(group.readings[begin], n, machine_, selected_.unknowns, residuals_.data(),
                                       jacobian_.data(), rows * n);
      square += residuals_.squaredNorm();
      for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t k = 0; k < n; ++k) {
          const Eigen::Map<const Eigen::Vector3d> z(poses_.displacement(group.readings[begin + k]) + 3 * row);
          const Index at = static_cast<Index>(row * n + k);
          along_residual += residuals_[at] * z;
          along += jacobian_.row(at).transpose() * z.transpose();
        }
      begin = end;
    }
    return square;
  }

 private:
  const SelectedObservations& selected_;
  const std::vector<std::size_t>& machine_;
  const PoseGroups& poses_;
  std::size_t columns_;
  Eigen::VectorXd residuals_;
  Eigen::MatrixXd jacobian_;
};

}  // namespace

void add_to(PoseSums& total, const PoseSums& part) {
  total.residuals += part.residuals;
  total.contrasts += part.contrasts;
  total.square += part.square;
  total.contrast_square += part.contrast_square;
  for (int i = 0; i < 3; ++i) total.inverse[i] += part.inverse[i];
  total.d_inverse2 += part.d_inverse2;
  total.dd_inverse2 += part.dd_inverse2;
  total.quadratic_factor += part.quadratic_factor;
  total.quadratic_pose += part.quadratic_pose;
  total.trace_pose += part.trace_pose;
  total.trace_mixed += part.trace_mixed;
  total.trace_twice += part.trace_twice;
}

std::vector<const WeighedObservations*> weighed_observations(const Problem& problem) {
  std::vector<const WeighedObservations*> result;
  for (const SelectedObservations& selected : problem.observations) {
    result.push_back(dynamic_cast<const WeighedObservations*>(selected.observations.get()));
    if (result.back() == nullptr) return {};
  }
  return result;
}

std::vector<ReadingPiece> divide_poses(const std::vector<const WeighedObservations*>& observations) {
  std::size_t groups = 0;
  for (const WeighedObservations* of_one : observations) groups += of_one->poses().groups().size();
  const std::size_t together = std::max(kPosesTogether, (groups + kMostPosePieces - 1) / kMostPosePieces);
  std::vector<ReadingPiece> pieces;
  for (std::size_t o = 0; o < observations.size(); ++o) {
    const std::size_t count = observations[o]->poses().groups().size();
    for (std::size_t first = 0; first < count; first += together)
      pieces.push_back({o, first, std::min(count, first + together)});
  }
  return pieces;
}

std::vector<double> sum_poses(const SelectedObservations& stated, const std::vector<std::size_t>& machine_parameters,
                              const PoseGroups& poses, const ReadingPiece& piece, const Eigen::MatrixXd& covariance,
                              const ReadingVariance& variance) {
  PoseSums sums;
  PoseRows rows(stated, machine_parameters, poses);
  const Index p = covariance.rows();
  Eigen::MatrixXd by_pose = Eigen::MatrixXd::Zero(p, p);
  Eigen::MatrixXd along(p, 3), contrasts(p, static_cast<Index>(3 * kPosesTogether)), spread, weighted;
  std::vector<double> squares;  // d of each column of contrasts
  const auto take = [&] {
    const Index n = static_cast<Index>(squares.size());
    if (n == 0) return;
    spread = covariance * contrasts.leftCols(n);
    weighted = contrasts.leftCols(n);
    for (Index j = 0; j < n; ++j) {
      const double d = squares[static_cast<std::size_t>(j)], lambda = variance.factor + variance.pose * d;
      const double seen = contrasts.col(j).dot(spread.col(j));
      sums.trace_pose += d / (lambda * lambda) * seen;
      sums.trace_mixed += d / (lambda * lambda * lambda) * seen;
      sums.trace_twice += d * d / (lambda * lambda * lambda) * seen;
      weighted.col(j) *= d / (lambda * lambda);
    }
    by_pose += weighted * contrasts.leftCols(n).transpose();
    squares.clear();
  };
  for (std::size_t g = piece.first; g < piece.last; ++g) {
    const PoseGroups::Group& group = poses.groups()[g];
    if (!group.used) continue;
    Eigen::Vector3d along_residual;
    sums.square += rows.add(group, along, along_residual);
    sums.residuals += static_cast<double>(poses.rows() * group.readings.size());
    for (int j = 0; j < 3; ++j) {
      const double d = group.squares[j];
      if (!(d > 0)) continue;
      const double lambda = variance.factor + variance.pose * d;
      const double rho = group.axes.col(j).dot(along_residual) / std::sqrt(d);
      contrasts.col(static_cast<Index>(squares.size())) = along * group.axes.col(j) / std::sqrt(d);
      squares.push_back(d);
      sums.contrasts += 1;
      sums.contrast_square += rho * rho;
      sums.inverse[0] += 1 / lambda;
      sums.inverse[1] += 1 / (lambda * lambda);
      sums.inverse[2] += d / lambda;
      sums.d_inverse2 += d / (lambda * lambda);
      sums.dd_inverse2 += d * d / (lambda * lambda);
      sums.quadratic_factor += rho * rho / (lambda * lambda);
      sums.quadratic_pose += d * rho * rho / (lambda * lambda);
    }
    if (squares.size() + 3 > 3 * kPosesTogether) take();
  }
  take();
  const auto scalars = std::bit_cast<std::array<double, kPoseSumCount>>(sums);
  std::vector<double> values(scalars.begin(), scalars.end());
  values.insert(values.end(), by_pose.data(), by_pose.data() + by_pose.size());
  return values;
}

PoseSums pose_sums_of(const std::vector<double>& values) {
  std::array<double, kPoseSumCount> scalars;
  std::copy_n(values.begin(), kPoseSumCount, scalars.begin());
  return std::bit_cast<PoseSums>(scalars);
}

}  // namespace abbe
