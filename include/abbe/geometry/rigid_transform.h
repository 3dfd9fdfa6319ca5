#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

namespace abbe {

/// Rigid motion x -> rotation * x + translation.
///
/// A name tells both frames: `workpiece_from_tool * p_tool = p_workpiece`. Lengths in mm.
///
/// The products are written out, in the order in which Eigen adds with vectors of two: nearly every source of the
/// library has them, and each would compile Eigen's templates for them anew.
struct RigidTransform {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  static RigidTransform translate(const Eigen::Vector3d& offset) { return {Eigen::Matrix3d::Identity(), offset}; }
  static RigidTransform rotate(const Eigen::Matrix3d& rotation) { return {rotation, Eigen::Vector3d::Zero()}; }

  RigidTransform inverse() const {
    const double* r = rotation.data();
    Eigen::Matrix3d back;
    double* b = back.data();
    for (int i = 0; i < 3; ++i) {
      b[i] = r[3 * i];
      b[3 + i] = r[3 * i + 1];
      b[6 + i] = r[3 * i + 2];
    }
    const double x = translation[0], y = translation[1], z = translation[2];
    return {back,
            {-((r[0] * x + r[1] * y) + r[2] * z), -((r[3] * x + r[4] * y) + r[5] * z),
             -((r[6] * x + r[7] * y) + r[8] * z)}};
  }

  friend RigidTransform operator*(const RigidTransform& a, const RigidTransform& b) {
    const double *left = a.rotation.data(), *right = b.rotation.data();
    Eigen::Matrix3d turned;
    double* out = turned.data();
    for (int j = 0; j < 9; j += 3) {
      const double x = right[j], y = right[j + 1], z = right[j + 2];
      out[j] = (left[0] * x + left[3] * y) + left[6] * z;
      out[j + 1] = (left[1] * x + left[4] * y) + left[7] * z;
      out[j + 2] = left[2] * x + (left[5] * y + left[8] * z);
    }
    return {turned, a * b.translation};
  }
  friend Eigen::Vector3d operator*(const RigidTransform& a, const Eigen::Vector3d& point) {
    const double *r = a.rotation.data(), *t = a.translation.data();
    const double x = point[0], y = point[1], z = point[2];
    return {((r[0] * x + r[3] * y) + r[6] * z) + t[0], ((r[1] * x + r[4] * y) + r[7] * z) + t[1],
            (r[2] * x + (r[5] * y + r[8] * z)) + t[2]};
  }
};

}  // namespace abbe
