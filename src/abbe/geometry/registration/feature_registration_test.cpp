#include "abbe/geometry/registration/feature_registration.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/registration/engraver_part_for_test.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using engraver::part;
using engraver::Scan;
using engraver::scan_of;

const RigidTransform kTruth = {rotation_from_vector({0.7, -0.4, 2.1}), {-614, 6, 551}};
RigidTransform beside() {
  return {rotation_from_vector({0.02, -0.02, 0.015}) * kTruth.rotation, kTruth.translation + Eigen::Vector3d(5, -6, 4)};
}

TEST(FeatureRegistration, ExactScansGiveThePoseExactly) {
  const Scan scan = scan_of(kTruth, 0, 0, 1);
  for (const RegistrationLoss loss : {RegistrationLoss::least_squares, RegistrationLoss::welsch}) {
    FeatureRegistrationOptions options;
    options.loss = loss;
    const FineRegistration fit = register_to_features(scan.points, part(), scan.labels, beside(), options);
    ASSERT_EQ(fit.status, FineRegistrationStatus::ok);
    const RigidTransform off = fit.mesh_from_scan * kTruth.inverse();
    EXPECT_LT(rotation_vector(off.rotation).norm(), 1e-12);
    EXPECT_LT((off * Eigen::Vector3d(110, 20, 160) - Eigen::Vector3d(110, 20, 160)).norm(), 1e-10);
  }
  // Without labels the nearest feature is as good a guess from a start that is not far.
  const RigidTransform near = {rotation_from_vector({1e-3, -1e-3, 1e-3}) * kTruth.rotation, kTruth.translation};
  const FineRegistration fit = register_to_features(scan.points, part(), {}, near);
  ASSERT_EQ(fit.status, FineRegistrationStatus::ok);
  EXPECT_LT((fit.mesh_from_scan.translation - kTruth.translation).norm(), 1e-9);
}

TEST(FeatureRegistration, OutliersDoNotMoveItAndItsUncertaintyHolds) {
  double squares = 0, plain = 0;
  constexpr int kRuns = 60;
  for (unsigned run = 0; run < kRuns; ++run) {
    const Scan scan = scan_of(kTruth, 0.02, 0.05, run + 3);
    const FineRegistration fit = register_to_features(scan.points, part(), scan.labels, beside());
    ASSERT_EQ(fit.status, FineRegistrationStatus::ok);
    const auto motion = [&](const FineRegistration& found) {
      const RigidTransform off = found.mesh_from_scan * kTruth.inverse();
      Vector6d v;
      v << rotation_vector(off.rotation), off * found.reference - found.reference;
      return v;
    };
    const Vector6d error = motion(fit);
    squares += error.dot(Ldlt<>(fit.covariance).solve(error)) / 6 / kRuns;
    FeatureRegistrationOptions options;
    options.loss = RegistrationLoss::least_squares;
    const Vector6d without = motion(register_to_features(scan.points, part(), scan.labels, beside(), options));
    plain += without.tail<3>().norm() / error.tail<3>().norm() / kRuns;
  }
  EXPECT_NEAR(squares, 1, 0.25);
  EXPECT_GT(plain, 5);
}

TEST(FeatureRegistration, WhatASurfaceDoesNotShowIsSaid) {
  const Scan scan = scan_of(kTruth, 0.02, 0, 5);
  std::vector<std::size_t> only_cylinder(450, 0);
  const std::vector<Shape> cylinder = {part()[0]};
  const FineRegistration fit = register_to_features(scan.points, cylinder, only_cylinder, kTruth);
  EXPECT_EQ(fit.status, FineRegistrationStatus::undetermined);
  // Along the axis, and about it.
  ASSERT_EQ(fit.undetermined.size(), 2U);
  for (const UndeterminedMotion& motion : fit.undetermined) {
    EXPECT_NEAR(std::abs(motion.direction.dot(cylinder[0].direction)), 1, 1e-6);
    if (!motion.rotation) continue;
    const Eigen::Vector3d beside = motion.point - cylinder[0].point;
    EXPECT_LT(beside.cross(cylinder[0].direction).norm(), 1e-3);
    EXPECT_EQ(motion.pitch_mm, 0);
  }
  EXPECT_NE(fit.undetermined[0].rotation, fit.undetermined[1].rotation);
  EXPECT_EQ(register_to_features(scan.points.leftCols(4), cylinder, {}, kTruth).status,
            FineRegistrationStatus::too_few_points);
  Shape circle;
  circle.kind = ShapeKind::circle3;
  EXPECT_THROW(register_to_features(scan.points, {circle}, {}, kTruth), std::invalid_argument);
}

TEST(FeatureRegistration, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  FeatureRegistrationOptions options;
  options.stop = source.get_token();
  EXPECT_THROW(register_to_features(scan_of(kTruth, 0, 0, 1).points, part(), {}, beside(), options), Stopped);
}

}  // namespace
}  // namespace abbe
