#include "abbe/geometry/registration/undetermined_motions.h"

#include <Eigen/Geometry>
#include <cmath>

#include "abbe/geometry/registration/fine_registration.h"
#include "abbe/geometry/singular_values.h"

namespace abbe {

using Eigen::MatrixXd;
using Eigen::Vector3d;

std::vector<UndeterminedMotion> undetermined_motions(const MatrixXd& unseen, double extent, const Vector3d& reference) {
  std::vector<UndeterminedMotion> motions;
  if (unseen.cols() == 0) return motions;
  // Combinations in the order of how much they turn.
  const RightSingular turning = right_singular(unseen.topRows(3));
  MatrixXd translations(3, 0);
  for (Eigen::Index k = unseen.cols(); k-- > 0;) {
    const Vector6d motion = unseen * turning.vectors.col(k);
    const double turn = motion.head<3>().norm();
    UndeterminedMotion named;
    if (turn < 0.02) {
      named.direction = motion.tail<3>().normalized();
      translations.conservativeResize(3, translations.cols() + 1);
      translations.rightCols(1) = named.direction;
    } else {
      const Vector3d omega = motion.head<3>() / extent;
      Vector3d shift = motion.tail<3>();
      shift -= translations * (translations.transpose() * shift);
      named.rotation = true;
      named.direction = omega.normalized();
      named.point = reference + omega.cross(shift) / omega.squaredNorm();
      named.pitch_mm = omega.dot(shift) / omega.squaredNorm();
      if (std::abs(named.pitch_mm) < 0.01 * extent) named.pitch_mm = 0;
    }
    Eigen::Index largest = 0;
    named.direction.cwiseAbs().maxCoeff(&largest);
    if (named.direction[largest] < 0) named.direction = -named.direction;
    motions.push_back(named);
  }
  return motions;
}

}  // namespace abbe
