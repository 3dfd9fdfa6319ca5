#include "abbe/plan/scans/turning_axis.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "abbe/geometry/rotation.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using std::numbers::pi;

TEST(TurningAxis, IsTheChuckForItsOwnAxisAndTheCradleForWhatLiesAcrossIt) {
  const Machine machine = test::liu_scanner();
  const std::size_t a = machine.find_axis("A"), c = machine.find_axis("C");
  const auto own = turning_axis(machine, -Eigen::Vector3d::UnitY());
  ASSERT_TRUE(own);
  EXPECT_EQ(own->axis, c);
  EXPECT_LT(own->tilt, 1e-12);
  EXPECT_LT((own->direction + Eigen::Vector3d::UnitY()).norm(), 1e-12);
  for (const double angle : {0.0, 0.4, 1.5, -2.0}) {
    // Across C: C turns it to where A lies.
    const Eigen::Vector3d across(std::cos(angle), 0, std::sin(angle));
    const auto cradle = turning_axis(machine, across);
    ASSERT_TRUE(cradle);
    EXPECT_EQ(cradle->axis, a) << angle;
    EXPECT_LT(cradle->tilt, 1e-7) << angle;
    EXPECT_LE(std::abs(cradle->positions[c]), pi / 2 + 1e-9);
    EXPECT_LT((axis_direction_in_workpiece(machine, a, cradle->positions).cross(across)).norm(), 1e-7);
  }
}

TEST(TurningAxis, LeavesTheAngleThatNoAxisTakesAway) {
  const Machine machine = test::liu_scanner();
  // 30 degrees from C, 60 degrees from where A can be brought.
  const auto turning = turning_axis(machine, Eigen::Vector3d(0.5, std::sqrt(0.75), 0));
  ASSERT_TRUE(turning);
  EXPECT_EQ(turning->axis, machine.find_axis("C"));
  EXPECT_NEAR(turning->tilt, pi / 6, 1e-12);
}

TEST(TurningAxis, KeepsToTheTravelOfTheAxesBetween) {
  Machine machine = test::liu_scanner();
  Axis& c = machine.axes[machine.find_axis("C")];
  c.endless = false;
  c.travel_min = -0.1;
  c.travel_max = 0.1;
  const auto turning = turning_axis(machine, Eigen::Vector3d(1, 0, 0));
  ASSERT_TRUE(turning);
  EXPECT_EQ(turning->axis, machine.find_axis("A"));
  const auto out_of_travel = turning_axis(machine, Eigen::Vector3d::UnitZ());
  ASSERT_TRUE(out_of_travel);
  EXPECT_GT(out_of_travel->tilt, 1.4);
}

TEST(TurningAxis, AgreesWithTheMotionOfTheChain) {
  // Turning the axis found moves the tool about its direction, as seen from the workpiece, whatever the machine.
  for (const test::NamedMachine& named : test::all_machines()) {
    const Machine& machine = named.machine;
    const auto turning = turning_axis(machine, Eigen::Vector3d(0.2, -0.3, 0.93).normalized());
    if (!turning) continue;
    std::vector<double> turned = turning->positions;
    turned[turning->axis] += 0.3;
    const Eigen::Matrix3d rotation = nominal_workpiece_from_tool(machine, turned).rotation *
                                     nominal_workpiece_from_tool(machine, turning->positions).rotation.transpose();
    const Eigen::Vector3d vector = rotation_vector(rotation);
    EXPECT_NEAR(vector.norm(), 0.3, 1e-9) << named.name;
    EXPECT_LT(vector.cross(turning->direction).norm(), 1e-9) << named.name;
  }
}

TEST(TurningAxis, TakesTwoAxesBetweenToAnyDirection) {
  // Three rotary axes in the head: the last one can stand in any direction.
  const Machine machine = test::three_axis_head();
  const Eigen::Vector3d direction = Eigen::Vector3d(0.3, 0.5, -0.4).normalized();
  const auto turning = turning_axis(machine, direction);
  ASSERT_TRUE(turning);
  EXPECT_LT(turning->tilt, 1e-6);
}

}  // namespace
}  // namespace abbe
