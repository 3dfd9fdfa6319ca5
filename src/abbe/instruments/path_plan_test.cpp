#include "abbe/instruments/path_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

TEST(Meet, BringsToolAndWorkpieceTogetherWhateverTheRotaryAxesDo) {
  const Machine machine = test::trunnion_mill();
  MeetingPoints points;
  points.on_from = machine.tool_offset;
  points.on_to = {30, -20, 50};
  for (const double a : {-0.4, 0.0, 0.5}) {
    std::vector<double> positions(machine.axes.size(), 0.0);
    positions[machine.find_axis("A")] = a;
    positions[machine.find_axis("C")] = 1.1;
    const auto pose = meet(machine, positions, Body::tool, Body::workpiece, points, {0, 0, 10});
    ASSERT_TRUE(pose.has_value());
    EXPECT_EQ((*pose)[machine.find_axis("A")], a);
    const Eigen::Vector3d tool = nominal_bed_from_tool(machine, *pose).translation;
    const Eigen::Vector3d table = nominal_bed_from_workpiece(machine, *pose) * points.on_to;
    EXPECT_LT((tool - table - Eigen::Vector3d(0, 0, 10)).norm(), 1e-9);
  }
}

TEST(Meet, SaysThatAPlaceIsOutOfReach) {
  const Machine machine = test::trunnion_mill();
  MeetingPoints points;
  points.on_to = {1e5, 0, 0};
  EXPECT_FALSE(meet(machine, std::vector<double>(machine.axes.size(), 0.0), Body::tool, Body::workpiece, points,
                    Eigen::Vector3d::Zero()));
  CircleDescription circle;
  circle.radius = 100;
  circle.to_angle = 1;
  circle.count = 3;
  EXPECT_THROW(
      circle_plan(machine, std::vector<double>(machine.axes.size(), 0.0), Body::tool, Body::workpiece, points, circle),
      std::invalid_argument);
}

TEST(Repeated, GoesThereAndBack) {
  PoseList poses;
  for (const double x : {1.0, 2.0, 3.0}) poses.append({x});
  EXPECT_EQ(repeated(poses, 2, true).axis[0], (std::vector<double>{1, 2, 3, 3, 2, 1}));
  EXPECT_EQ(repeated(poses, 2, false).axis[0], (std::vector<double>{1, 2, 3, 1, 2, 3}));
}

}  // namespace
}  // namespace abbe
