#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/identify/linkage/dial_decoupling.h"

namespace abbe {

/// Error motions of a whole machine put together from its axes.
struct DecoupledErrors {
  ErrorSet errors;             ///< tables over the positions of each axis, with standard uncertainties
  Eigen::MatrixXd covariance;  ///< of ErrorSet::parameters(), [p, p]; axes are independent of each other
};

/// One decoupled axis; an axis may come more than once with different components.
struct DecoupledAxis {
  std::size_t axis = 0;  ///< index into Machine::axes
  Decoupling decoupling;
};

/// Every component seen becomes a table-linear error motion; components not seen have none.
/// @throws std::invalid_argument if an axis was not decoupled (status not ok)
DecoupledErrors decoupled_errors(const std::vector<DecoupledAxis>& axes);

}  // namespace abbe
