#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

namespace abbe {

/// Rigid motion x -> rotation * x + translation.
///
/// A name tells both frames: `workpiece_from_tool * p_tool = p_workpiece`. Lengths in mm.
struct RigidTransform {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  static RigidTransform translate(const Eigen::Vector3d& offset) { return {Eigen::Matrix3d::Identity(), offset}; }
  static RigidTransform rotate(const Eigen::Matrix3d& rotation) { return {rotation, Eigen::Vector3d::Zero()}; }

  RigidTransform inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }

  friend RigidTransform operator*(const RigidTransform& a, const RigidTransform& b) {
    return {a.rotation * b.rotation, a.rotation * b.translation + a.translation};
  }
  friend Eigen::Vector3d operator*(const RigidTransform& a, const Eigen::Vector3d& point) {
    return a.rotation * point + a.translation;
  }
};

}  // namespace abbe
