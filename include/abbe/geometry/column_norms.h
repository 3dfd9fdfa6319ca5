#pragma once

#include <Eigen/Core>

namespace abbe {

/// Sets norms of columns to 0 that are rounding of a column that is zero: up to 1e-14 of the largest.
void drop_rounding_columns(Eigen::VectorXd& norms);

}  // namespace abbe
