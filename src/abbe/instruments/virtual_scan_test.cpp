#include "abbe/instruments/virtual_scan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/geometry/rotation.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

/// A large square in z = 0 of its frame, normal along z.
TriangleMesh plate() {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << -500, 500, 500, -500, -500, -500, 500, 500, 0, 0, 0, 0;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 0, 1, 2, 2, 3;
  return mesh;
}

Machine scanner() { return test::liu_scanner(); }

ErrorSet some_errors(const Machine& machine) {
  ErrorSet errors;
  errors.locations = {{machine.find_axis("C"), Component::X, 0.05, 0}, {machine.find_axis("A"), Component::B, 1e-3, 0}};
  errors.tool_offset_error = {0.01, -0.02, 0.03};
  return errors;
}

PoseList some_poses(const Machine& machine) {
  PoseList poses;
  for (int k = 0; k < 60; ++k) {
    std::vector<double> positions(machine.axes.size(), 0.0);
    positions[machine.find_axis("X")] = 0.1 * k;
    positions[machine.find_axis("Y")] = 5 * std::sin(0.3 * k);
    positions[machine.find_axis("A")] = 0.002 * (k - 30);
    positions[machine.find_axis("C")] = 0.003 * (k - 20);
    poses.append(positions);
  }
  return poses;
}

TEST(VirtualScan, PointsOfTheSameMachineLieOnThePartWhereItIsClamped) {
  const Machine machine = scanner();
  const ErrorSet errors = some_errors(machine);
  VirtualScanSetup setup;
  setup.workpiece_from_part = {rotation_from_error_angles({0.02, -0.01, 0.3}), {1, 2, 10}};
  setup.following_axis = machine.find_axis("Z");
  setup.search = 3;
  const VirtualScan scan = scan_part(machine, errors, RayTracer(plate()), some_poses(machine), setup);
  ASSERT_GT(scan.indication.size(), 50U);
  const Eigen::Matrix3Xd points = scanned_points(machine, errors, setup.beam, scan);
  const RigidTransform part_from_workpiece = setup.workpiece_from_part.inverse();
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    ASSERT_NEAR((part_from_workpiece * Eigen::Vector3d(points.col(i))).z(), 0, 1e-10) << i;
  }
  for (const double indication : scan.indication) EXPECT_LE(std::abs(indication), 0.2);
}

TEST(VirtualScan, LosesWhatIsOutOfRangeAndWhatIsTooSteep) {
  const Machine machine = scanner();
  VirtualScanSetup setup;
  setup.workpiece_from_part.translation.z() = 10.05;
  PoseList poses;
  std::vector<double> positions(machine.axes.size(), 0.0);
  for (const double z : {0.0, 0.1, 0.3, -0.3}) {
    positions[machine.find_axis("Z")] = z;
    poses.append(positions);
  }
  // 27 and 29 degrees about the plate's edge below the beam.
  const VirtualScan level = scan_part(machine, {}, RayTracer(plate()), poses, setup);
  ASSERT_EQ(level.indication.size(), 2U);
  EXPECT_NEAR(level.indication[0], 0, 1e-12);
  EXPECT_NEAR(level.indication[1], 0.1, 1e-12);
  EXPECT_EQ(level.no_surface, 2U);
  for (const double degrees : {27.0, 29.0}) {
    setup.workpiece_from_part.rotation = rotation_from_error_angles({0, degrees * 3.14159265358979 / 180, 0});
    const VirtualScan steep = scan_part(machine, {}, RayTracer(plate()), poses, setup);
    EXPECT_EQ(steep.too_steep, degrees > 28 ? 2U : 0U) << degrees;
  }
  // Seen from the other side it is no surface either.
  setup.workpiece_from_part.rotation = rotation_from_error_angles({3.14159265358979, 0, 0});
  EXPECT_EQ(scan_part(machine, {}, RayTracer(plate()), poses, setup).too_steep, 2U);
}

TEST(VirtualScan, NoiseIsThatOfTheSetUp) {
  const Machine machine = scanner();
  VirtualScanSetup setup;
  setup.workpiece_from_part.translation.z() = 10.05;
  setup.linear_noise = 1e-3;
  setup.probe_noise = 2e-3;
  PoseList poses;
  for (int k = 0; k < 4000; ++k) poses.append(std::vector<double>(machine.axes.size(), 0.0));
  const VirtualScan scan = scan_part(machine, {}, RayTracer(plate()), poses, setup);
  double sum = 0, squares = 0;
  for (const double h : scan.indication) {
    sum += h;
    squares += h * h;
  }
  const double n = static_cast<double>(scan.indication.size());
  // Across a plate Z alone counts: sqrt(1 + 4) um, four standard deviations of the estimate aside.
  EXPECT_NEAR(std::sqrt(squares / n), std::sqrt(5.0) * 1e-3, 4 * std::sqrt(5.0) * 1e-3 / std::sqrt(2 * n));
  EXPECT_NEAR(sum / n, 0, 4 * std::sqrt(5.0) * 1e-3 / std::sqrt(n));
}

}  // namespace
}  // namespace abbe
