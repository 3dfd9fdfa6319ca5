#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "abbe/compensate/compensated_inverse.h"
#include "abbe/compensate/left_out_errors.h"
#include "abbe/compensate/workpiece_expansion.h"
#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// How far rotary axes may turn for a correction where nothing else is asked for, rad. The axes of an arm turn for
/// every correction of the point, not only near singularities.
inline constexpr double kLargestTurn = 0.5 * kDegree, kLargestTurnOfArm = 5 * kDegree;

struct CorrectedPosesOptions {
  std::optional<double> largest_turn{};  ///< of rotary axes, rad; none: kLargestTurn, of an arm kLargestTurnOfArm
  double leave_out_factor = 0;           ///< errors below so many of their standard uncertainties are left out; 0: none
  std::vector<std::size_t> held{};       ///< axes that keep their commands
  /// The tool is brought to where the points of the workpiece are at its temperature.
  std::optional<WorkpieceExpansion> workpiece{};
};

/// A figure and the pose where it is, from 1; 0: nowhere.
struct LargestOfRows {
  double value = 0;
  std::size_t row = 0;
  void take(double other, std::size_t at) {
    if (!(std::abs(other) > value)) return;
    value = std::abs(other);
    row = at;
  }
};

/// Commands corrected pose by pose, and what is left.
struct CorrectedPoses {
  std::string problem;  ///< why no pose can be corrected on this machine; empty: they can
  PoseList commands;
  std::vector<CorrectionStatus> status;                 ///< [poses]
  std::vector<double> position_left, orientation_left;  ///< [poses] mm, rad; NaN where not known
  std::vector<double> shift;                            ///< [poses] of the functional point, mm; NaN where not known
  std::vector<double> uncertainty;  ///< [poses] standard, of that, mm; empty: none is stated of the errors
  std::array<std::size_t, kCorrectionStatuses> count{}, first_row{};  ///< of every status
  LargestOfRows largest_shift, largest_position_left, largest_orientation_left;
  std::vector<LargestOfRows> by_axis;  ///< [axes] change of the commands, mm or rad
  LeftOutErrors left_out;              ///< errors below their uncertainty
};

/// Axis commands that bring the actual tool to where the nominal machine has it, pose by pose: point and direction, of
/// an arm the full pose. States that are computed from the commands follow the corrected ones; poses that do not give a
/// measured state of the errors are not covered; those without the temperature of an expanding workpiece are not
/// finite.
/// @param covariance  of errors.parameters(), or 0 x 0: what the errors state of their standard uncertainties
CorrectedPoses corrected_poses(const Machine& machine, const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                               const PoseList& poses, const CorrectedPosesOptions& options = {});

}  // namespace abbe
