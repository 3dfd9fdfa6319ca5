#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/geometry/best_fit_transform.h"
#include "abbe/machine/machine.h"
#include "abbe/verify/evaluations/statistics.h"

namespace abbe {

/// What a compensation leaves of the errors of a machine at poses, each pose one value.
struct CompensatedPoses {
  std::size_t outside_travel = 0;  ///< the corrected commands leave the travel
  std::size_t not_reached = 0;     ///< no command of the axes that are corrected reaches the point
  std::size_t not_covered = 0;     ///< outside the range in which one of the errors is known
  /// Of the workpiece datum. Where it is not ok, the turn of the workpiece is not determined by the poses, and the
  /// lists and figures below are empty.
  BestFitStatus datum = BestFitStatus::not_run;

  std::vector<double> before, after;                      ///< volumetric error, mm
  std::vector<double> direction_before, direction_after;  ///< angle of the tool's direction to the wanted one, rad
  /// Predicted standard uncertainty of the volumetric error after correction: root of the sum of the variances of the
  /// three coordinates, mm; empty without a covariance.
  std::vector<double> uncertainty;
  double coverage = 0;  ///< share of the coordinates within twice their predicted standard uncertainty, 0..1

  SampleStatistics before_statistics, after_statistics, direction_before_statistics, direction_after_statistics,
      uncertainty_statistics;

  /// Mean volumetric error before over that after.
  double reduction() const;
  /// Root mean square volumetric error after correction over the predicted one; 0 without a covariance.
  double uncertainty_ratio() const;
};

/// Commands corrected for identified errors, carried out by a machine with the true ones.
///
/// Command q, corrected by the compensated inverse for the mean of both directions, less approach B / 2 with the
/// identified reversal value B; the true machine carries it out with its own. The displacement from where the nominal
/// machine has the tool at q is what is left after the best rigid motion of the workpiece over all poses: its datum,
/// which the user of a machine sets by probing. Before: the commands as they are, the same way.
///
/// The prediction is the covariance of the identified errors at those poses, without what a rigid motion takes up,
/// (I - P) J C J' (I - P), to first order (verify/parts/determined_part.h).
/// @param commands    [axes][poses]; with approach where reversal values are to act
/// @param covariance  of identified.parameters(), or 0 x 0
/// @throws std::invalid_argument if the commands do not fit the machine or cannot be corrected at all, and as
///         covariance_root()
CompensatedPoses check_compensated_poses(const Machine& machine, const ErrorSet& truth, const ErrorSet& identified,
                                         const Eigen::MatrixXd& covariance, const PoseList& commands);

/// Displacement of the functional point at commands as they are: where a machine with `actual` errors has the tool,
/// minus where one with `wanted` errors has it, each coming from the sides that the list knows, after the best fit of
/// the workpiece datum. With no errors wanted its length is `before` of check_compensated_poses() at the same poses.
/// @param used  [poses] 0: the pose takes no part; becomes 0 where the errors of either machine are not known
/// @return [3, poses] in the workpiece frame, mm, 0 where a pose takes no part; [3, 0] if the poses that do leave the
///         turn of the workpiece open
Eigen::Matrix3Xd errors_at_commands(const Machine& machine, const ErrorSet& actual, const ErrorSet& wanted,
                                    const PoseList& commands, std::vector<std::uint8_t>& used);

}  // namespace abbe
