#include "abbe/verify/parts/small_motion.h"

#include <Eigen/Geometry>
#include <cmath>

#include "abbe/geometry/decompositions.h"

namespace abbe {

SmallMotion fit_small_motion(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& directions,
                             const Eigen::VectorXd& seen) {
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  SmallMotion motion;
  const Eigen::Index count = points.cols();
  if (count == 0) return motion;
  motion.centre = points.rowwise().mean();
  double size = std::sqrt((points.colwise() - motion.centre).squaredNorm() / static_cast<double>(count));
  if (!(size > 0)) size = 1;
  Matrix6d normal = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Vector3d along = directions.col(k), arm = (points.col(k) - motion.centre) / size;
    Vector6d row;
    row << along, arm.cross(along);
    normal += row * row.transpose();
    right += seen[k] * row;
  }
  // Squares of singular values: 1e-10 is 1e-5 of the largest of them.
  const SymmetricEigen<6> values(normal);
  const double smallest = 1e-10 * values.eigenvalues()[5];
  Vector6d solution = Vector6d::Zero();
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (!(values.eigenvalues()[i] > smallest)) continue;
    ++motion.rank;
    const Vector6d vector = values.eigenvectors().col(i);
    solution += vector.dot(right) / values.eigenvalues()[i] * vector;
  }
  motion.shift = solution.head<3>();
  motion.turn = solution.tail<3>() / size;
  return motion;
}

}  // namespace abbe
