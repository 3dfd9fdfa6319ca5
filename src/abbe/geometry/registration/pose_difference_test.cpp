#include "abbe/geometry/registration/pose_difference.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <vector>

#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

constexpr double kExtent = 20;
const Vector3d kMiddle(3, -2, 7);
const RigidTransform kPose{rotation_from_vector({0.4, -1.1, 2.0}), {12, -40, 5}};

RigidTransform turn_about(const Vector3d& point, const Vector3d& axis, double angle) {
  const Eigen::Matrix3d rotation = rotation_about(axis.normalized(), angle);
  return {rotation, point - rotation * point};
}

TEST(PoseDifference, WithoutUndeterminedMotionsIsTheScrewItself) {
  EXPECT_LT(pose_difference(kPose, kPose, {}, kMiddle, kExtent), 1e-13);
  EXPECT_NEAR(pose_difference(kPose, RigidTransform::translate({3, 4, 0}) * kPose, {}, kMiddle, kExtent), 5, 1e-12);
  EXPECT_NEAR(pose_difference(kPose, turn_about(kMiddle, {1, 2, 2}, 0.3) * kPose, {}, kMiddle, kExtent), 0.3 * kExtent,
              1e-12);
}

TEST(PoseDifference, TurnsAndShiftsOfACylinderCountNothing) {
  const Vector3d axis = Vector3d(1, 2, -2).normalized(), point(4, 1, 5);
  const std::vector<UndeterminedMotion> wall{{.direction = axis},
                                             {.rotation = true, .direction = axis, .point = point}};
  for (const double angle : {0.1, 2.0, 3.1, -3.0}) {
    const RigidTransform same = turn_about(point, axis, angle) * RigidTransform::translate(55 * axis) * kPose;
    EXPECT_LT(pose_difference(kPose, same, wall, kMiddle, kExtent), 1e-9) << angle;
    EXPECT_GT(pose_difference(kPose, same, std::vector{wall[0]}, kMiddle, kExtent), 1) << angle;
    // Upside down it is another pose, wherever it is turned to.
    const RigidTransform turned = same * kPose.inverse() * turn_about(point, axis.unitOrthogonal(), 3.14159) * kPose;
    EXPECT_GT(pose_difference(kPose, turned, wall, kMiddle, kExtent), 3 * kExtent) << angle;
    const RigidTransform aside = RigidTransform::translate(0.5 * axis.unitOrthogonal()) * same;
    EXPECT_NEAR(pose_difference(kPose, aside, wall, kMiddle, kExtent), 0.5, 0.3) << angle;
  }
}

TEST(PoseDifference, TurnsAboutACentreInAnyOrderCountNothing) {
  const Vector3d centre(1, 2, 3);
  std::vector<UndeterminedMotion> ball;
  for (int k = 0; k < 3; ++k) ball.push_back({.rotation = true, .direction = Vector3d::Unit(k), .point = centre});
  const RigidTransform same = turn_about(centre, {1, 0, 0}, 2) * turn_about(centre, {1, 5, 0}, -1.5) *
                              turn_about(centre, {0, 1, 1}, 2.5) * kPose;
  EXPECT_LT(pose_difference(kPose, same, ball, kMiddle, kExtent), 1e-8);
  EXPECT_NEAR(pose_difference(kPose, RigidTransform::translate({0, 0, 2}) * same, ball, kMiddle, kExtent), 2, 0.2);
}

TEST(PoseDifference, MotionsOfAPlaneCountNothing) {
  const std::vector<UndeterminedMotion> plane{{.direction = Vector3d::UnitX()},
                                              {.direction = Vector3d::UnitY()},
                                              {.rotation = true, .direction = Vector3d::UnitZ(), .point = kMiddle}};
  const RigidTransform same = RigidTransform::translate({100, -50, 0}) * turn_about({9, 9, 9}, {0, 0, 1}, 2.9) * kPose;
  EXPECT_LT(pose_difference(kPose, same, plane, kMiddle, kExtent), 1e-8);
  EXPECT_NEAR(pose_difference(kPose, RigidTransform::translate({0, 0, 2}) * same, plane, kMiddle, kExtent), 2, 1e-6);
}

TEST(PoseDifference, AScrewKeepsItsPitch) {
  const std::vector<UndeterminedMotion> thread{
      {.rotation = true, .direction = Vector3d::UnitZ(), .point = {0, 0, 0}, .pitch_mm = 1.5}};
  const RigidTransform along = RigidTransform::translate({0, 0, 1.5 * 2.2}) * turn_about({0, 0, 0}, {0, 0, 1}, 2.2);
  EXPECT_LT(pose_difference(kPose, along * kPose, thread, kMiddle, kExtent), 1e-9);
  EXPECT_GT(pose_difference(kPose, turn_about({0, 0, 0}, {0, 0, 1}, 2.2) * kPose, thread, kMiddle, kExtent), 1);
}

}  // namespace
}  // namespace abbe
