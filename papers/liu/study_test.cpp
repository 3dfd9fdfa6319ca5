#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "abbe/geometry/surface/mesh_check.h"
#include "liu/machine.h"
#include "liu/measurement.h"
#include "liu/parts.h"

namespace abbe {
namespace {

double largest(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) { return (a - b).colwise().norm().maxCoeff(); }

TEST(LiuRecursion, EqualsTheReferenceWithTheOrderOfTheChainAndIsMillimetresOffAsWorded) {
  const Machine machine = liu_machine();
  const LiuReference reference = read_liu_reference(machine);
  const ErrorSet errors = liu_errors(machine, LiuUnit::millimetre);
  ASSERT_GE(reference.indication.size(), 30U);
  EXPECT_LT(largest(liu_recursion(machine, errors, reference.positions, reference.indication, LiuRecursion::corrected),
                    reference.millimetre),
            1e-9);
  EXPECT_GT(largest(liu_recursion(machine, errors, reference.positions, reference.indication, LiuRecursion::as_worded),
                    reference.millimetre),
            1.0);
}

TEST(LiuParts, AreClosedMeshes) {
  for (const LiuPart& part :
       {liu_cylinder(10, 0.0006), liu_cross_cylinder(), liu_pyramid(), liu_blade(), liu_sphere(0.7)}) {
    const MeshCheck check = check_mesh(part.mesh);
    EXPECT_TRUE(check.encloses_volume()) << part.name << " " << check.border_edges << " " << check.turned_edges;
    EXPECT_GT(check.volume, 0) << part.name;
  }
}

TEST(LiuParts, HaveTheVolumesOfTheirShapes) {
  const auto volume = [](const LiuPart& part) { return check_mesh(part.mesh).volume; };
  using std::numbers::pi;
  EXPECT_NEAR(volume(liu_cylinder(10, 0)) / (pi * 100 * 30), 1, 1e-5);
  EXPECT_NEAR(volume(liu_sphere(0.5)) / (4 * pi / 3 * std::pow(12.703, 3)), 1, 1e-4);
  // A corner of a cube, half of which is above the hexagon through its middle, on the prism of that hexagon.
  const double side = 5, hexagon = std::sqrt(3.0) * side * side, top = 5 - std::sqrt(3.0) / 2 * side;
  EXPECT_NEAR(volume(liu_pyramid()), side * side * side / 2 + hexagon * (top + 20), 1e-6);
  EXPECT_NEAR(volume(liu_blade()) / (pi * 7 * 1.5 * 24), 1, 2e-3);
}

TEST(LiuCalibration, WithoutNoiseFindsTheAxesAndLeavesNothingOfThePart) {
  const Machine machine = liu_machine();
  LiuScanner scanner;
  scanner.unit = LiuUnit::millimetre;
  scanner.noise = false;
  const LiuCalibration calibration = liu_calibrate(machine, scanner);
  ASSERT_TRUE(calibration.converged) << calibration.message;
  // What is left is the chord error of the cylinder's mesh, 0.02 um.
  for (std::size_t stage = 0; stage < 2; ++stage) {
    EXPECT_LT(calibration.direction[stage], 1e-6);
    EXPECT_LT(calibration.distance[stage], 3e-5);
  }
  const LiuPart pyramid = liu_pyramid();
  const ScanPlan plan = liu_plan(machine, pyramid, liu_clamping(scanner.unit));
  const LiuMeasurement measured = liu_measure(machine, scanner, calibration.errors, pyramid, pyramid.mesh, plan);
  EXPECT_TRUE(measured.before.registered && measured.after.registered);
  EXPECT_GT(measured.after.points, 500U);
  EXPECT_GT(measured.before.rms, 0.02);
  EXPECT_LT(measured.after.rms, 3e-5);
}

}  // namespace
}  // namespace abbe
