#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "abbe/identify/sums/reading_pieces.h"
#include "abbe/identify/weighed_observations.h"

namespace abbe {

/// Sums over poses for the restricted likelihood. In the basis of the residuals of a pose that its covariance has as
/// axes, the variance is lambda = factor + pose d along up to three contrasts q = z u / sqrt(d), and factor across
/// them.
struct PoseSums {
  double residuals = 0, contrasts = 0;                      // their numbers
  double square = 0, contrast_square = 0;                   // r'r and the part along the contrasts
  double inverse[3] = {0, 0, 0};                            // sums of 1/lambda, 1/lambda^2 and d/lambda
  double d_inverse2 = 0, dd_inverse2 = 0;                   // d/lambda^2, d^2/lambda^2
  double quadratic_factor = 0, quadratic_pose = 0;          // rho^2/lambda^2, d rho^2/lambda^2
  double trace_pose = 0, trace_mixed = 0, trace_twice = 0;  // d/lambda^2, d/lambda^3, d^2/lambda^3 times g'Cg
};
inline constexpr std::size_t kPoseSumCount = sizeof(PoseSums) / sizeof(double);

void add_to(PoseSums& total, const PoseSums& part);

/// The observations of a problem with weights, or nothing if one of them has none.
std::vector<const WeighedObservations*> weighed_observations(const Problem& problem);

/// Divides the poses of all observations into pieces, first and last of which are groups of PoseGroups: consecutive
/// ones of one set of observations, the least number from 64 on with which the groups of all make no more than 48
/// pieces; there may be as many more as there are sets, as in divide_readings().
std::vector<ReadingPiece> divide_poses(const std::vector<const WeighedObservations*>& observations);

/// Values of a piece, SumKind::poses: PoseSums, then the sum of d/lambda^2 g g' by columns, [c, c].
/// @param stated      the observations without the weights, at the estimates
/// @param covariance  [c, c] of the estimates of the piece's columns
std::vector<double> sum_poses(const SelectedObservations& stated, const std::vector<std::size_t>& machine_parameters,
                              const PoseGroups& poses, const ReadingPiece& piece, const Eigen::MatrixXd& covariance,
                              const ReadingVariance& variance);

PoseSums pose_sums_of(const std::vector<double>& values);

}  // namespace abbe
