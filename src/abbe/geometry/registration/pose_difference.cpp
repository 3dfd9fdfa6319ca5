#include "abbe/geometry/registration/pose_difference.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Motion = Eigen::Matrix<double, 6, 1>;

/// Shift of the reference by a screw = this matrix times the velocity of the reference. Source: Murray, Li, Sastry, A
/// Mathematical Introduction to Robotic Manipulation (1994) 2.36.
Matrix3d shift_of_velocity(const Vector3d& turn) {
  const double angle = turn.norm();
  const Matrix3d k = skew(turn);
  if (angle < 1e-4) return Matrix3d::Identity() + k / 2 + k * k / 6;
  return Matrix3d::Identity() + (1 - std::cos(angle)) / (angle * angle) * k +
         (angle - std::sin(angle)) / (angle * angle * angle) * k * k;
}

/// Rotation vector and velocity of the reference of the screw that makes a transform.
Motion screw_of(const RigidTransform& transform, const Vector3d& reference) {
  Motion screw;
  const Vector3d turn = rotation_vector(transform.rotation);
  screw << turn, shift_of_velocity(turn).inverse() * (transform * reference - reference);
  return screw;
}

RigidTransform transform_of(const Motion& screw, const Vector3d& reference) {
  const Vector3d turn = screw.head<3>();
  const Matrix3d rotation = rotation_from_vector(turn);
  return {rotation, reference - rotation * reference + shift_of_velocity(turn) * screw.tail<3>()};
}

}  // namespace

double pose_difference(const RigidTransform& mesh_from_scan, const RigidTransform& other,
                       std::span<const UndeterminedMotion> undetermined, const Vector3d& reference, double extent) {
  RigidTransform difference = other * mesh_from_scan.inverse();
  Motion levers;
  levers << extent, extent, extent, 1, 1, 1;
  Eigen::MatrixXd unseen(6, static_cast<Eigen::Index>(undetermined.size()));
  for (std::size_t i = 0; i < undetermined.size(); ++i) {
    const UndeterminedMotion& motion = undetermined[i];
    const Eigen::Index column = static_cast<Eigen::Index>(i);
    if (motion.rotation) {
      unseen.col(column) << motion.direction,
          motion.direction.cross(reference - motion.point) + motion.pitch_mm * motion.direction;
    } else {
      unseen.col(column) << Vector3d::Zero(), motion.direction;
    }
    unseen.col(column) = levers.asDiagonal() * unseen.col(column);
  }
  Motion screw = levers.asDiagonal() * screw_of(difference, reference);
  double length = screw.norm();
  if (undetermined.empty()) return length;
  // Normal equations do: the columns are few and far from parallel.
  const FullLu<> gram(unseen.transpose() * unseen);
  for (int step = 0; step < 20; ++step) {
    const Motion along = unseen * gram.solve(unseen.transpose() * screw);
    // Motions that do not commute leave a rest, which the next step takes.
    difference = transform_of(-(levers.cwiseInverse().asDiagonal() * along), reference) * difference;
    screw = levers.asDiagonal() * screw_of(difference, reference);
    length = std::min(length, screw.norm());
    if (along.norm() < 1e-9 * extent) break;
  }
  return length;
}

}  // namespace abbe
