#include "abbe/geometry/rotation.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numbers>
#include <random>

#include "abbe/geometry/rigid_transform.h"

namespace abbe {
namespace {

Eigen::Vector3d random_vector(std::mt19937_64& generator, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  return {uniform(generator), uniform(generator), uniform(generator)};
}

TEST(Rotation, ErrorAnglesComposeZThenYThenX) {
  const double quarter = std::numbers::pi / 2;
  // EA first turns y to z; EB then turns z to x.
  const Eigen::Vector3d turned = rotation_from_error_angles({quarter, quarter, 0}) * Eigen::Vector3d::UnitY();
  EXPECT_NEAR((turned - Eigen::Vector3d::UnitX()).norm(), 0, 1e-15);
}

TEST(Rotation, ErrorAnglesAndRotationVectorAreInverted) {
  std::mt19937_64 generator(1);
  for (int i = 0; i < 200; ++i) {
    const double size = std::pow(10.0, -(i % 12));
    const Eigen::Vector3d angles = random_vector(generator, size);
    EXPECT_LE((error_angles_from_rotation(rotation_from_error_angles(angles)) - angles).norm(), 1e-15 + 1e-14 * size);
    EXPECT_LE((rotation_vector(rotation_from_vector(angles)) - angles).norm(), 1e-15 + 1e-14 * size);
  }
}

TEST(Rotation, ErrorAnglesKeepTheRotationWhereOnlyASumOfThemCounts) {
  std::mt19937_64 generator(2);
  for (const double off : {0.0, 1e-16, 1e-12, 1e-6, 1e-3, 1e-1}) {
    for (const double quarter : {std::numbers::pi / 2, -std::numbers::pi / 2}) {
      Eigen::Vector3d angles = random_vector(generator, 1);
      angles.y() = quarter + off;
      const Eigen::Matrix3d rotation = rotation_from_error_angles(angles);
      EXPECT_LE((rotation_from_error_angles(error_angles_from_rotation(rotation)) - rotation).norm(), 1e-14) << off;
    }
  }
}

TEST(Rotation, RotationVectorIsAccurateNearHalfATurn) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 3).normalized();
  for (double gap : {1e-3, 1e-6, 1e-9}) {
    const Eigen::Vector3d vector = axis * (std::numbers::pi - gap);
    EXPECT_LE((rotation_vector(rotation_from_vector(vector)) - vector).norm(), 1e-13);
  }
}

TEST(Rotation, ErrorAngleAxesMatchDifferences) {
  const Eigen::Vector3d angles(0.3, -0.2, 0.9);
  const Eigen::Matrix3d axes = error_angle_axes(angles);
  const double step = 1e-6;
  for (int k = 0; k < 3; ++k) {
    Eigen::Vector3d more = angles, less = angles;
    more[k] += step;
    less[k] -= step;
    const Eigen::Matrix3d derivative =
        (rotation_from_error_angles(more) - rotation_from_error_angles(less)) / (2 * step);
    const Eigen::Matrix3d expected = skew(axes.col(k)) * rotation_from_error_angles(angles);
    EXPECT_LE((derivative - expected).norm(), 1e-9);
  }
}

TEST(RigidTransform, InverseUndoesAndProductComposes) {
  std::mt19937_64 generator(2);
  for (int i = 0; i < 50; ++i) {
    const RigidTransform a{rotation_from_vector(random_vector(generator, 2)), random_vector(generator, 1000)};
    const RigidTransform b{rotation_from_vector(random_vector(generator, 2)), random_vector(generator, 1000)};
    const Eigen::Vector3d p = random_vector(generator, 1000);
    EXPECT_LE(((a * b) * p - a * (b * p)).norm(), 1e-11);
    EXPECT_LE(((a.inverse() * a) * p - p).norm(), 1e-11);
  }
}

TEST(Rotation, BetweenDirectionsIsTheSmallestOne) {
  std::mt19937_64 generator(3);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d from = random_vector(generator, 5), to = random_vector(generator, 5);
    const Eigen::Matrix3d turn = rotation_between(from, to);
    // Near opposite directions rounding of the cosine counts for more.
    const double cosine = from.normalized().dot(to.normalized());
    EXPECT_LE((turn * from.normalized() - to.normalized()).norm(), 8e-15 / (1 + cosine));
    EXPECT_NEAR(rotation_vector(turn).norm(), std::acos(cosine), 1e-8);
    for (const Eigen::Vector3d& opposite : {Eigen::Vector3d(-from), Eigen::Vector3d(-from + 1e-9 * to)}) {
      EXPECT_LE((rotation_between(from, opposite) * from.normalized() - opposite.normalized()).norm(), 1e-6);
    }
  }
}

}  // namespace
}  // namespace abbe
