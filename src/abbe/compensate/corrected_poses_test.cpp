#include "abbe/compensate/corrected_poses.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/errors/actual_pose.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

PoseList poses_of_trunnion(const Machine& machine) {
  PoseList poses;
  std::vector<double> pose(machine.axes.size(), 0);
  pose[machine.find_axis("Z")] = -100;
  poses.append(pose);
  pose[machine.find_axis("X")] = 50;
  pose[machine.find_axis("A")] = -0.4;
  poses.append(pose);
  return poses;
}

TEST(CorrectedPoses, BringTheActualToolWhereTheNominalMachineHasIt) {
  const Machine machine = test::trunnion_mill();
  ErrorSet errors;
  errors.tool_offset_error = Eigen::Vector3d(0.02, -0.01, 0.03);
  const PoseList poses = poses_of_trunnion(machine);
  const CorrectedPoses result = corrected_poses(machine, errors, {}, poses);
  ASSERT_EQ(result.problem, "");
  ASSERT_EQ(result.commands.count(), 2U);
  EXPECT_TRUE(result.uncertainty.empty());
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_TRUE(reaches_point(result.status[k]));
    EXPECT_NEAR(result.shift[k], errors.tool_offset_error.norm(), 1e-9);
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, poses.pose(k));
    const RigidTransform actual = actual_workpiece_from_tool(machine, errors, result.commands.pose(k));
    EXPECT_NEAR((actual.translation - wanted.translation).norm(), result.position_left[k], 1e-9);
    EXPECT_LT(result.position_left[k], 1e-6);
  }
  EXPECT_GT(result.largest_shift.row, 0U);
  EXPECT_NEAR(result.largest_shift.value, errors.tool_offset_error.norm(), 1e-9);
}

TEST(CorrectedPoses, HeldAxesKeepTheirCommands) {
  const Machine machine = test::trunnion_mill();
  ErrorSet errors;
  errors.tool_offset_error = Eigen::Vector3d(0.02, -0.01, 0.03);
  const PoseList poses = poses_of_trunnion(machine);
  const std::size_t held = machine.find_axis("Y");
  const CorrectedPoses result = corrected_poses(machine, errors, {}, poses, {.held = {held}});
  ASSERT_EQ(result.problem, "");
  EXPECT_EQ(result.commands.axis[held], poses.axis[held]);
  EXPECT_EQ(result.by_axis[held].row, 0U);
}

}  // namespace
}  // namespace abbe
