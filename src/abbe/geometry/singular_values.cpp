#include "abbe/geometry/singular_values.h"

#include "abbe/geometry/decompositions.h"

namespace abbe {

RightSingular right_singular(const Eigen::MatrixXd& matrix) {
  const SingularValues<> svd(matrix, Eigen::ComputeFullV);
  return {svd.values(), svd.v()};
}

}  // namespace abbe
