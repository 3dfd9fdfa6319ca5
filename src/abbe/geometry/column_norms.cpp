#include "abbe/geometry/column_norms.h"

namespace abbe {

void drop_rounding_columns(Eigen::VectorXd& norms) {
  if (norms.size() == 0) return;
  const double no_column = 1e-14 * norms.maxCoeff();
  for (Eigen::Index i = 0; i < norms.size(); ++i)
    if (norms[i] <= no_column) norms[i] = 0;
}

}  // namespace abbe
