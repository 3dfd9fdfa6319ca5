#include "abbe/geometry/feature_registration.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

/// A cylinder segment between two planes: as the part of a laser engraver.
std::vector<Shape> part() {
  Shape cylinder, top, side;
  cylinder.kind = ShapeKind::cylinder;
  cylinder.point = {75, -506, 0};
  cylinder.direction = Eigen::Vector3d::UnitZ();
  cylinder.radius = 528;
  top.kind = side.kind = ShapeKind::plane;
  top.point = {0, 0, 205};
  top.direction = Eigen::Vector3d::UnitZ();
  side.point = {155, 0, 0};
  side.direction = Eigen::Vector3d::UnitX();
  return {cylinder, top, side};
}

struct Scan {
  Eigen::Matrix3Xd points;
  std::vector<std::size_t> labels;
};

Scan scan_of(const RigidTransform& part_from_scan, double noise, double outliers, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0, noise > 0 ? noise : 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  Scan scan;
  scan.points.resize(3, 450);
  const RigidTransform back = part_from_scan.inverse();
  for (int i = 0; i < 450; ++i) {
    const std::size_t label = static_cast<std::size_t>(i % 3);
    const double x = 80 + 70 * uniform(generator), z = 130 + 70 * uniform(generator), depth = 30 * uniform(generator);
    const double y = -506 + std::sqrt(528.0 * 528.0 - (x - 75) * (x - 75));
    Eigen::Vector3d p = label == 0   ? Eigen::Vector3d(x, y, z)
                        : label == 1 ? Eigen::Vector3d(x, y - depth, 205)
                                     : Eigen::Vector3d(155, y - depth, z);
    if (noise > 0) p += Eigen::Vector3d(normal(generator), normal(generator), normal(generator));
    if (uniform(generator) < outliers) p.y() += 0.2 + 2 * uniform(generator);
    scan.points.col(i) = back * p;
    scan.labels.push_back(label);
  }
  return scan;
}

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
    squares += error.dot(fit.covariance.ldlt().solve(error)) / 6 / kRuns;
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
  EXPECT_EQ(register_to_features(scan.points, cylinder, only_cylinder, kTruth).status,
            FineRegistrationStatus::undetermined);
  EXPECT_EQ(register_to_features(scan.points.leftCols(4), cylinder, {}, kTruth).status,
            FineRegistrationStatus::too_few_points);
  Shape circle;
  circle.kind = ShapeKind::circle3;
  EXPECT_THROW(register_to_features(scan.points, {circle}, {}, kTruth), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
