#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// How the functional point moves at poses when errors of the machine change, and when the workpiece datum does.
/// Rows: three per covered pose, x, y, z in the workpiece frame.
struct DisplacementFields {
  std::vector<std::size_t> pose;  ///< the covered poses
  Eigen::MatrixXd by_parameter;   ///< [3 poses, n] mm per mm or rad
  Eigen::MatrixXd by_motion;      ///< [3 poses, 6] rigid motions of the workpiece, columns of length 1 at most
  double size = 0;                ///< root mean square distance of the points from their middle, mm
};

/// @param parameters  indices into ErrorSet::parameters(), [n]
/// @param covered     per pose: 0 leaves it out
/// @throws std::invalid_argument if the poses do not fit the machine
DisplacementFields displacement_fields(const Machine& machine, const ErrorSet& errors,
                                       const std::vector<std::size_t>& parameters, const PoseSource& poses,
                                       const std::vector<std::uint8_t>& covered);

/// The same at poses of which it may be known from which side the axes came: there a reversal value displaces by half
/// the approach times the derivative by its axis's command (ReversalShift). Without an approach its column is 0.
DisplacementFields displacement_fields(const Machine& machine, const ErrorSet& errors,
                                       const std::vector<std::size_t>& parameters, const PoseList& poses,
                                       const std::vector<std::uint8_t>& covered);

/// Orthonormal columns that span those of `columns`, which have comparable lengths.
/// @param threshold  a column that is left with less than this part of the longest one's pivot adds nothing
Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& columns, double threshold);

/// Takes the part in the span of orthonormal columns out of `from`.
void remove_span(const Eigen::MatrixXd& span, Eigen::MatrixXd& from);

}  // namespace abbe
