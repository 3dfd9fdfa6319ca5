#pragma once

#include <Eigen/Core>

#include "abbe/errors/error_set.h"
#include "abbe/identify/linkage/swing_head_linkage.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// What a measured linkage says of the errors of a machine.
struct LinkageErrors {
  /// EX0C1, EY0C1, EY0A, EZ0A and the tool offset error: as many as linkage parameters.
  ErrorSet errors;
  Eigen::MatrixXd covariance;  ///< [7, 7] of errors.parameters(), mm^2
};

/// The errors that make the nominal machine one of the linkage that was found, with the covariance of the linkage.
///
///     EX0C1 = dx0, EY0C1 = dy0, EY0A = dL_AC1 + dy0, EZ0A = s dz0
///     tool  = (dR_C1 + dx0, dL_tA + EY0A, s (dR_A + dz0))      d: found less nominal; s = -1 in U, +1 in P
/// @param covariance  [7, 7] of SwingHeadLinkage::values(), mm^2
/// @throws std::invalid_argument if the machine has no axis C1 or A
LinkageErrors linkage_errors(const Machine& machine, LinkageConvention convention, const SwingHeadLinkage& found,
                             const Eigen::MatrixXd& covariance);

/// The convention that a machine's chain means: `table_moves` if its X carries the workpiece.
/// @throws std::invalid_argument if the machine has no axis X
LinkageConvention linkage_convention_of(const Machine& machine);

}  // namespace abbe
