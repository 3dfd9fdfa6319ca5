#include "abbe/geometry/singular_values.h"

#include <Eigen/SVD>

namespace abbe {

RightSingular right_singular(const Eigen::MatrixXd& matrix) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

}  // namespace abbe
