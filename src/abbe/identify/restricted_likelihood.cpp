#include "abbe/identify/restricted_likelihood.h"

#include <algorithm>
#include <cmath>

#include "abbe/geometry/parallel_blocks.h"
#include "abbe/identify/normal_equations.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
constexpr std::size_t kMostPosePieces = 48;
constexpr std::size_t kPosesTogether = 64;  // their rows make one matrix product

/// Sums over poses. In the basis of the residuals of a pose that its covariance has as axes, the variance is
/// lambda = factor + pose d along up to three contrasts q = z u / sqrt(d), and factor across them.
struct PoseSums {
  double residuals = 0, contrasts = 0;                      // their numbers
  double square = 0, contrast_square = 0;                   // r'r and the part along the contrasts
  double inverse[3] = {0, 0, 0};                            // sums of 1/lambda, 1/lambda^2 and d/lambda
  double d_inverse2 = 0, dd_inverse2 = 0;                   // d/lambda^2, d^2/lambda^2
  double quadratic_factor = 0, quadratic_pose = 0;          // rho^2/lambda^2, d rho^2/lambda^2
  double trace_pose = 0, trace_mixed = 0, trace_twice = 0;  // d/lambda^2, d/lambda^3, d^2/lambda^3 times g'Cg
  Eigen::MatrixXd by_pose;                                  // sum of d/lambda^2 g g'
};

struct PosePiece {
  std::size_t observations = 0, first = 0, last = 0;  // groups
};

/// Columns of the estimates on which some observations depend.
std::vector<Index> columns_of(const Problem& problem, std::size_t observations) {
  std::vector<Index> columns;
  for (std::size_t i = 0; i < problem.machine_parameters.size(); ++i) columns.push_back(static_cast<Index>(i));
  std::size_t next = columns.size();
  for (std::size_t o = 0; o < observations; ++o) next += problem.observations[o].unknowns.size();
  for (std::size_t i = 0; i < problem.observations[observations].unknowns.size(); ++i)
    columns.push_back(static_cast<Index>(next++));
  return columns;
}

/// Residuals and Jacobian of the readings of one pose: adds up what they do along the directions of z.
class PoseRows {
 public:
  PoseRows(const Problem& problem, const PoseGroups& poses, std::size_t observations)
      : selected_(problem.observations[observations]),
        machine_(problem.machine_parameters),
        poses_(poses),
        columns_(machine_.size() + selected_.unknowns.size()) {}

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

PoseSums sums_of_piece(const Problem& problem, const PoseGroups& poses, const PosePiece& piece,
                       const Eigen::MatrixXd& covariance, const ReadingVariance& variance) {
  PoseSums sums;
  PoseRows rows(problem, poses, piece.observations);
  const Index p = covariance.rows();
  sums.by_pose = Eigen::MatrixXd::Zero(p, p);
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
    sums.by_pose += weighted * contrasts.leftCols(n).transpose();
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
  return sums;
}

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

}  // namespace

RestrictedLikelihood restricted_likelihood(const Problem& problem, std::span<const PoseGroups* const> poses,
                                           const Identification& identification, const ReadingVariance& variance,
                                           int threads) {
  std::size_t groups = 0;
  for (const PoseGroups* of_one : poses) groups += of_one->groups().size();
  const std::size_t together = std::max(kPosesTogether, (groups + kMostPosePieces - 1) / kMostPosePieces);
  std::vector<PosePiece> pieces;
  std::vector<std::vector<Index>> columns;
  std::vector<Eigen::MatrixXd> covariances;
  for (std::size_t o = 0; o < poses.size(); ++o) {
    const std::size_t count = poses[o]->groups().size();
    for (std::size_t first = 0; first < count; first += together)
      pieces.push_back({o, first, std::min(count, first + together)});
    columns.push_back(columns_of(problem, o));
    covariances.emplace_back(identification.covariance(columns.back(), columns.back()));
  }
  std::vector<PoseSums> parts(pieces.size());
  for_each_block(pieces.size(), threads, [&](std::size_t i) {
    const std::size_t o = pieces[i].observations;
    parts[i] = sums_of_piece(problem, *poses[o], pieces[i], covariances[o], variance);
  });
  PoseSums sums;
  const Index p = identification.estimates.size();
  sums.by_pose = Eigen::MatrixXd::Zero(p, p);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    add_to(sums, parts[i]);
    const std::vector<Index>& at = columns[pieces[i].observations];
    sums.by_pose(at, at) += parts[i].by_pose;
  }

  // C (J'V^-1 J + prior) C = C, and factor V_factor + pose V_pose = V: what belongs to the variance factor follows from
  // these and from what belongs to the pose variance.
  const Eigen::MatrixXd& c = identification.covariance;
  const double s = variance.factor, t = variance.pose;
  const Eigen::MatrixXd prior = prior_rows(problem);
  const Eigen::MatrixXd known = prior * c * prior.transpose();  // [prior rows, prior rows]
  const Eigen::MatrixXd c_pose = c * sums.by_pose;
  const double free = static_cast<double>(identification.statistics.parameter_count);
  const double of_readings = free - known.trace();                               // tr(C N), N = J'V^-1 J
  const double readings_twice = free - 2 * known.trace() + known.squaredNorm();  // tr(C N C N)
  const double readings_pose = sums.trace_pose - (prior * c_pose * c * prior.transpose()).trace();  // tr(C N C A_pose)
  const double pose_twice = c_pose.cwiseProduct(c_pose.transpose()).sum();  // tr(C A_pose C A_pose)

  const double across = sums.residuals - sums.contrasts;
  const double factor_trace = (of_readings - t * sums.trace_pose) / s;    // tr(C J'V^-2 J)
  const double factor_cubed = (factor_trace - t * sums.trace_mixed) / s;  // tr(C J'V^-3 J)
  RestrictedLikelihood result;
  result.residual_count = sums.residuals;
  result.taken_by_parameters = of_readings;
  result.score[0] = -0.5 * (sums.inverse[0] + across / s - factor_trace -
                            (sums.quadratic_factor + (sums.square - sums.contrast_square) / (s * s)));
  result.score[1] = -0.5 * (sums.inverse[2] - sums.trace_pose - sums.quadratic_pose);
  result.information(0, 0) = 0.5 * (sums.inverse[1] + across / (s * s) - 2 * factor_cubed +
                                    (readings_twice - 2 * t * readings_pose + t * t * pose_twice) / (s * s));
  result.information(0, 1) = 0.5 * (sums.d_inverse2 - 2 * sums.trace_mixed + (readings_pose - t * pose_twice) / s);
  result.information(1, 0) = result.information(0, 1);
  result.information(1, 1) = 0.5 * (sums.dd_inverse2 - 2 * sums.trace_twice + pose_twice);
  return result;
}

}  // namespace abbe
