#include "abbe/identify/restricted_likelihood.h"

#include <cassert>

#include "abbe/identify/normal_equations.h"
#include "abbe/identify/sums/pose_sums.h"

namespace abbe {

RestrictedLikelihood restricted_likelihood(const Problem& problem, const Identification& identification,
                                           const SolverOptions& solver) {
  using Index = Eigen::Index;
  const std::vector<const WeighedObservations*> observations = weighed_observations(problem);
  assert(!observations.empty());
  const ReadingVariance variance = observations.front()->weights().variance;
  const ReadingStream stream(problem, solver.threads, solver.summation, solver.stop);
  const std::vector<std::vector<double>> values = stream.pose_sums(identification.estimates, identification.covariance);
  const std::vector<ReadingPiece> pieces = divide_poses(observations);
  PoseSums sums;
  const Index p = identification.estimates.size();
  Eigen::MatrixXd by_pose = Eigen::MatrixXd::Zero(p, p);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    add_to(sums, pose_sums_of(values[i]));
    const std::vector<std::size_t>& columns = stream.columns_of(pieces[i].observations);
    const std::vector<Index> at(columns.begin(), columns.end());
    const Index c = static_cast<Index>(at.size());
    by_pose(at, at) += Eigen::Map<const Eigen::MatrixXd>(values[i].data() + kPoseSumCount, c, c);
  }

  // C (J'V^-1 J + prior) C = C, and factor V_factor + pose V_pose = V: what belongs to the variance factor follows from
  // these and from what belongs to the pose variance.
  const Eigen::MatrixXd& c = identification.covariance;
  const double s = variance.factor, t = variance.pose;
  const Eigen::MatrixXd prior = prior_rows(problem);
  const Eigen::MatrixXd known = prior * c * prior.transpose();  // [prior rows, prior rows]
  const Eigen::MatrixXd c_pose = c * by_pose;
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
