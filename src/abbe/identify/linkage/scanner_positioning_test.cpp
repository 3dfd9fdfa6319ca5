#include "abbe/identify/linkage/scanner_positioning.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/registration/engraver_part_for_test.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using Points = std::vector<Eigen::Vector3d>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Where the scanner stands on the table when the sphere is scanned, and where it then has moved to.
const RigidTransform kTableFromScanner = {rotation_from_vector({2.6, 0.9, -0.4}), {-390, -151, 518}};
const Eigen::Vector3d kMoved(150, -60, 0);
const RigidTransform kLater = {kTableFromScanner.rotation, kTableFromScanner.translation - kMoved};
const RigidTransform kTableFromWorkpiece = {rotation_from_vector({-1.8e-3, -6e-4, -1.7e-3}), {73.9, -94.8, -33.4}};
const Eigen::Vector3d kSphere(60, -80, 95);

PositioningScans exact_scans() {
  const RigidTransform scanner_from_table = kTableFromScanner.inverse();
  const auto seen = [&](const Eigen::Vector3d& table, Points& points) { points.push_back(scanner_from_table * table); };
  PositioningScans scans;
  scans.circles.resize(2);
  for (int i = 0; i <= 10; ++i) {
    seen(Eigen::Vector3d(20.0 * i - 100, 40, 12), scans.along_x);
    seen(Eigen::Vector3d(30, 20.0 * i - 100, 12), scans.along_y);
  }
  for (int i = 0; i < 12; ++i) {
    const Eigen::Matrix3d turned = rotation_about(Eigen::Vector3d::UnitZ(), 30 * i * kDegree);
    seen(turned * Eigen::Vector3d(110, 20, 10), scans.circles[0]);
    seen(turned * Eigen::Vector3d(-40, 80, 60), scans.circles[1]);
  }
  RandomStream random(1);
  while (scans.sphere.size() < 300) {
    const Eigen::Vector3d normal = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    if (normal.z() > 0) seen(kSphere + 12.7 * normal, scans.sphere);
  }
  scans.sphere_height = kSphere.z();
  scans.moved_since = kMoved;
  return scans;
}

Eigen::Matrix<double, 6, 1> motion(const RigidTransform& measured, const RigidTransform& from,
                                   const Eigen::Vector3d& at) {
  const RigidTransform off = measured * from.inverse();
  Eigen::Matrix<double, 6, 1> v;
  v << off * at - at, rotation_vector(off.rotation);
  return v;
}

// The reference's scans: papers/yin/study_test.cpp.
TEST(ScannerPositioning, ExactScansGiveScannerAndWorkpieceExactly) {
  const ScannerPosition found = locate_scanner(exact_scans());
  ASSERT_EQ(found.status, PositioningStatus::ok) << found.reason;
  EXPECT_LT(motion(found.table_from_scanner, kLater, Eigen::Vector3d::Zero()).norm(), 1e-9);
  EXPECT_LT(found.axis_tilt.norm() + std::abs(found.squareness), 1e-12);
  const RigidTransform workpiece_from_scanner = kTableFromWorkpiece.inverse() * kLater;
  const engraver::Scan scan = engraver::scan_of(workpiece_from_scanner, 0, 0, 2);
  const RigidTransform start = {rotation_from_vector({0.02, 0.01, -0.02}) * workpiece_from_scanner.rotation,
                                workpiece_from_scanner.translation + Eigen::Vector3d(4, -5, 6)};
  const FineRegistration registered = register_to_features(scan.points, engraver::part(), scan.labels, start);
  ASSERT_EQ(registered.status, FineRegistrationStatus::ok);
  const Placement placement = locate_workpiece(found, registered);
  EXPECT_LT(motion(placement.table_from_workpiece, kTableFromWorkpiece, Eigen::Vector3d::Zero()).norm(), 1e-9);
  for (const bool to_workpiece : {true, false}) {
    const PositioningParameters read = positioning_parameters(placement, to_workpiece);
    const RigidTransform d = {rotation_xyz(read.angles), read.translation};
    EXPECT_LT(motion(to_workpiece ? d.inverse() : d, kTableFromWorkpiece, Eigen::Vector3d::Zero()).norm(), 1e-9);
  }
}

TEST(ScannerPositioning, StatedCovarianceIsThatOfRepeatedMeasurements) {
  const PositioningScans exact = exact_scans();
  const Placement truth = {kTableFromWorkpiece};
  const RigidTransform workpiece_from_scanner = kTableFromWorkpiece.inverse() * kLater;
  const Eigen::Vector3d centre = kTableFromScanner.inverse() * kSphere;
  RandomStream random(42);
  constexpr int kRuns = 250;
  double scanner_squares = 0, placement_squares = 0, parameter_squares = 0;
  for (int run = 0; run < kRuns; ++run) {
    const auto noise = [&](double sigma) -> Eigen::Vector3d {
      return sigma * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    };
    PositioningScans scans = exact;
    scans.target_noise = 0.010;
    scans.sphere_noise = 0.020;
    scans.height_noise = 0.005;
    for (Points* points : {&scans.along_x, &scans.along_y, &scans.circles[0], &scans.circles[1]}) {
      for (Eigen::Vector3d& p : *points) p += noise(0.010);
    }
    for (Eigen::Vector3d& p : scans.sphere) p += 0.020 * random.normal() * (p - centre).normalized();
    scans.sphere_height += 0.005 * random.normal();
    const engraver::Scan scan = engraver::scan_of(workpiece_from_scanner, 0.020, 0.05, static_cast<unsigned>(run) + 1);
    const ScannerPosition found = locate_scanner(scans);
    ASSERT_EQ(found.status, PositioningStatus::ok) << found.reason;
    const FineRegistration registered =
        register_to_features(scan.points, engraver::part(), scan.labels, workpiece_from_scanner);
    ASSERT_EQ(registered.status, FineRegistrationStatus::ok);
    const auto error = motion(found.table_from_scanner, kLater, Eigen::Vector3d::Zero());
    scanner_squares += error.dot(Ldlt<>(found.covariance).solve(error)) / 6 / kRuns;
    const Placement placement = locate_workpiece(found, registered);
    const auto placed =
        motion(placement.table_from_workpiece, truth.table_from_workpiece, truth.table_from_workpiece.translation);
    placement_squares += placed.dot(Ldlt<>(*placement.covariance).solve(placed)) / 6 / kRuns;
    const PositioningParameters parameters = positioning_parameters(placement, true);
    Eigen::Matrix<double, 6, 1> six;
    const PositioningParameters exactly = positioning_parameters(truth, true);
    six << parameters.translation - exactly.translation, parameters.angles - exactly.angles;
    parameter_squares += six.dot(Ldlt<>(parameters.covariance).solve(six)) / 6 / kRuns;
  }
  // Mean of chi-square over its degrees of freedom: 1 within 3 times sqrt(2 / (6 * 250)) = 0.11.
  EXPECT_NEAR(scanner_squares, 1, 0.12);
  EXPECT_NEAR(placement_squares, 1, 0.12);
  EXPECT_NEAR(parameter_squares, placement_squares, 0.01);
}

TEST(ScannerPositioning, WhatContradictsItselfIsRefused) {
  PositioningScans scans = exact_scans();
  scans.turned_positively = false;
  EXPECT_EQ(locate_scanner(scans).status, PositioningStatus::inconsistent);
  scans = exact_scans();
  for (Points& circle : scans.circles) std::reverse(circle.begin(), circle.end());
  EXPECT_EQ(locate_scanner(scans).status, PositioningStatus::inconsistent);
  scans.turned_positively = false;
  EXPECT_EQ(locate_scanner(scans).status, PositioningStatus::ok);
  scans = exact_scans();
  for (Points& circle : scans.circles) {
    // Half turns: either sense.
    const Eigen::Vector3d far = circle[6];
    circle = {circle[0], far, circle[0], far, circle[0]};
  }
  EXPECT_NE(locate_scanner(scans).status, PositioningStatus::ok);
  scans = exact_scans();
  scans.along_x.resize(1);
  EXPECT_EQ(locate_scanner(scans).status, PositioningStatus::bad_line);
  scans = exact_scans();
  scans.along_y = scans.along_x;
  EXPECT_EQ(locate_scanner(scans).status, PositioningStatus::bad_line);
  scans = exact_scans();
  for (Points& circle : scans.circles) circle.resize(1);
  EXPECT_EQ(locate_scanner(scans).status, PositioningStatus::bad_circles);
  scans = exact_scans();
  scans.sphere.resize(3);
  EXPECT_EQ(locate_scanner(scans).status, PositioningStatus::bad_sphere);
}

}  // namespace
}  // namespace abbe
