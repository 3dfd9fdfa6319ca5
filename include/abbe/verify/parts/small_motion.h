#pragma once

#include <Eigen/Core>

namespace abbe {

/// Rigid motion so small that rotations are vectors: a point x moves by shift + turn x (x - centre).
struct SmallMotion {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< mm
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();   ///< mm
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();    ///< rad
  int rank = 0;                                      ///< freedoms that the readings determine; the others stay 0

  Eigen::Vector3d at(const Eigen::Vector3d& point) const { return shift + turn.cross(point - centre); }
};

/// The small motion that explains displacements seen along given directions best (least squares).
///
/// A surface that a motion does not change, such as a cone turned about its axis, leaves it open: of all that fit
/// equally the shortest is taken.
/// @param points      [3, n] mm
/// @param directions  [3, n] along which a displacement is seen; of any length, which weighs it
/// @param seen        [n] displacement along the direction, times its length, mm
SmallMotion fit_small_motion(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& directions,
                             const Eigen::VectorXd& seen);

}  // namespace abbe
