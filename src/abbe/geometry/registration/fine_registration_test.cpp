#include "abbe/geometry/registration/fine_registration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/geometry/fits/numbers_for_test.h"
#include "abbe/geometry/parts_for_test.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::Numbers;

struct Part {
  TriangleMesh mesh;
  ClosestPointFinder finder;
  SmoothSurface smooth;
  explicit Part(TriangleMesh m) : mesh(std::move(m)), finder(mesh), smooth(mesh) {}
};

RigidTransform near_pose(double turn, double shift, std::uint64_t seed) {
  Numbers numbers(seed);
  return {rotation_about(numbers.normal3().normalized(), turn), shift * numbers.normal3()};
}

/// Points of the part in the frame of a scan.
Matrix3Xd scanned(const Matrix3Xd& points, const RigidTransform& mesh_from_scan) {
  const RigidTransform back = mesh_from_scan.inverse();
  return (back.rotation * points).colwise() + back.translation;
}

double pose_error_mm(const RigidTransform& a, const RigidTransform& b, double radius) {
  const RigidTransform difference = a * b.inverse();
  return rotation_vector(difference.rotation).norm() * radius + (difference.translation).norm();
}

TEST(FineRegistration, FindsThePoseOfAnExactScanToRounding) {
  for (const bool curved : {false, true}) {
    const Part part(curved ? parts::blade(48, 60) : parts::stepped_box(2));
    const Matrix3Xd points = parts::sample(part.mesh, 4000, 3).points;
    const RigidTransform truth = near_pose(0.06, 0.7, 5);
    for (const bool adaptive : {false, true}) {
      for (const RegistrationLoss loss :
           {RegistrationLoss::least_squares, RegistrationLoss::welsch, RegistrationLoss::tukey}) {
        const FineRegistration fit = register_finely(scanned(points, truth), part.finder, part.smooth, {},
                                                     {.loss = loss, .adaptive_distance = adaptive});
        EXPECT_EQ(fit.status, FineRegistrationStatus::ok) << curved << adaptive << static_cast<int>(loss);
        EXPECT_LT(pose_error_mm(fit.mesh_from_scan, truth, 30), 1e-7) << curved << adaptive << static_cast<int>(loss);
      }
    }
  }
}

TEST(FineRegistration, ThirtyPercentOutliersMoveTheRobustFitByItsUncertaintyOnly) {
  const Part part(parts::stepped_box(1));
  Numbers numbers(8);
  Matrix3Xd points = parts::sample(part.mesh, 6000, 4).points;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    points.col(i) += 0.005 * numbers.normal3();
    // Something that stands in front of one side, not noise around it.
    if (i % 10 < 3) points.col(i) = Vector3d(numbers.uniform(0, 60), numbers.uniform(0, 30), numbers.uniform(24, 34));
  }
  const RigidTransform truth = near_pose(0.03, 0.4, 6);
  for (const RegistrationLoss loss : {RegistrationLoss::welsch, RegistrationLoss::tukey}) {
    const FineRegistration fit = register_finely(scanned(points, truth), part.finder, part.smooth, {}, {.loss = loss});
    ASSERT_EQ(fit.status, FineRegistrationStatus::ok);
    const RigidTransform difference = fit.mesh_from_scan * truth.inverse();
    Vector6d error;
    error << rotation_vector(difference.rotation), difference * fit.reference - fit.reference;
    for (int k = 0; k < 6; ++k) EXPECT_LT(std::abs(error[k]), 4 * std::sqrt(fit.covariance(k, k))) << k;
    EXPECT_LT(std::sqrt(fit.covariance.bottomRightCorner<3, 3>().trace()), 0.0006);
    EXPECT_NEAR(fit.scale_mm, 0.005, 0.004);
  }
  const FineRegistration least_squares =
      register_finely(scanned(points, truth), part.finder, part.smooth, {}, {.loss = RegistrationLoss::least_squares});
  EXPECT_GT(pose_error_mm(least_squares.mesh_from_scan, truth, 30), 0.1) << "what the robust weights are for";
}

TEST(FineRegistration, CovarianceIsThatOfManyRepetitions) {
  const Part part(parts::stepped_box());
  const Matrix3Xd exact = parts::sample(part.mesh, 400, 14).points;
  const int repetitions = 150;
  Vector6d chi_square = Vector6d::Zero();
  for (int r = 0; r < repetitions; ++r) {
    Numbers numbers(100 + static_cast<std::uint64_t>(r));
    Matrix3Xd points = exact;
    for (Eigen::Index i = 0; i < points.cols(); ++i) points.col(i) += 0.01 * numbers.normal3();
    const FineRegistration fit =
        register_finely(points, part.finder, part.smooth, {}, {.movement_mm = 1e-6, .threads = 1});
    ASSERT_EQ(fit.status, FineRegistrationStatus::ok);
    Vector6d error;
    error << rotation_vector(fit.mesh_from_scan.rotation), fit.mesh_from_scan * fit.reference - fit.reference;
    for (int k = 0; k < 6; ++k) chi_square[k] += error[k] * error[k] / fit.covariance(k, k) / repetitions;
  }
  // Mean of squared normal deviates: 1 with standard deviation sqrt(2/150) = 0.115.
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(chi_square[k], 1, 0.45) << k;
}

TEST(FineRegistration, DoesNotDependOnThreads) {
  const Part part(parts::blade(30, 40));
  const Matrix3Xd points = scanned(parts::sample(part.mesh, 7000, 2).points, near_pose(0.02, 0.3, 9));
  const FineRegistration one = register_finely(points, part.finder, part.smooth, {}, {.threads = 1});
  const FineRegistration three = register_finely(points, part.finder, part.smooth, {}, {.threads = 3});
  EXPECT_EQ(one.mesh_from_scan.rotation, three.mesh_from_scan.rotation);
  EXPECT_EQ(one.mesh_from_scan.translation, three.mesh_from_scan.translation);
  EXPECT_EQ(one.covariance, three.covariance);
}

TEST(FineRegistration, MotionsThatAScanOfACylinderDoesNotShowAreNamed) {
  const Part part(parts::cylinder_with_flats(8, 40, 90, 30, {}));
  // Without the ends nothing tells the place along the axis.
  const Matrix3Xd wall = parts::sample(part.mesh, 4000, 7, [](const Vector3d& p, const Vector3d&) {
                           return p.z() > 5 && p.z() < 35;
                         }).points;
  const FineRegistration fit = register_finely(scanned(wall, near_pose(0.02, 0.2, 3)), part.finder, part.smooth, {});
  ASSERT_EQ(fit.status, FineRegistrationStatus::undetermined);
  ASSERT_EQ(fit.undetermined.size(), 2u);
  EXPECT_FALSE(fit.undetermined[0].rotation);
  EXPECT_NEAR(fit.undetermined[0].direction.z(), 1, 1e-4);
  EXPECT_TRUE(fit.undetermined[1].rotation);
  EXPECT_NEAR(fit.undetermined[1].direction.z(), 1, 1e-4);
  EXPECT_LT(fit.undetermined[1].point.head<2>().norm(), 0.02);
  EXPECT_LT(fit.covariance(5, 5), 1e-12) << "no uncertainty is invented for what is not determined";

  const Matrix3Xd all = parts::sample(part.mesh, 4000, 7).points;
  const FineRegistration with_ends =
      register_finely(scanned(all, near_pose(0.02, 0.2, 3)), part.finder, part.smooth, {});
  ASSERT_EQ(with_ends.undetermined.size(), 1u);
  EXPECT_TRUE(with_ends.undetermined[0].rotation);

  const Part flat(parts::cylinder_with_flats(8, 40, 90, 30, {{5, 0.3}}));
  const FineRegistration keyed = register_finely(
      scanned(parts::sample(flat.mesh, 4000, 7).points, near_pose(0.02, 0.2, 3)), flat.finder, flat.smooth, {});
  EXPECT_EQ(keyed.status, FineRegistrationStatus::ok) << "the flat shows the turn";
}

TEST(FineRegistration, AScanOfASphereShowsItsCentreOnly) {
  const Part part(parts::sphere(10, 160, 80, {1, 2, 3}));
  const Matrix3Xd cap =
      parts::sample(part.mesh, 3000, 7, [](const Vector3d&, const Vector3d& n) { return n.z() > 0.3; }).points;
  const FineRegistration fit = register_finely(scanned(cap, near_pose(0, 0.2, 3)), part.finder, part.smooth, {});
  ASSERT_EQ(fit.undetermined.size(), 3u);
  for (const UndeterminedMotion& motion : fit.undetermined) {
    EXPECT_TRUE(motion.rotation);
    EXPECT_LT((motion.point - Vector3d(1, 2, 3)).cross(motion.direction).norm() - Vector3d(0, 0, 0).norm(), 0.05)
        << "through the centre";
  }
  EXPECT_LT(((fit.mesh_from_scan * near_pose(0, 0.2, 3).inverse()) * Vector3d(1, 2, 3) - Vector3d(1, 2, 3)).norm(),
            0.01);
}

TEST(FineRegistration, TooFewPointsAreSaid) {
  const Part part(parts::stepped_box());
  EXPECT_EQ(register_finely(Matrix3Xd::Zero(3, 4), part.finder, part.smooth, {}).status,
            FineRegistrationStatus::too_few_points);
  EXPECT_EQ(register_finely(Matrix3Xd::Zero(3, 40), part.finder, part.smooth, {}).status,
            FineRegistrationStatus::too_few_points);
}

}  // namespace
}  // namespace abbe
