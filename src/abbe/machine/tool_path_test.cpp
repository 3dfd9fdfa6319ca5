#include "abbe/machine/tool_path.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/machines_for_test.h"
#include "abbe/machine/placement.h"
#include "abbe/machine/tool_path_miss.h"

namespace abbe {
namespace {

/// An arc in a horizontal plane, the tool tilted by 30 degrees outwards.
Curve arc(std::size_t count) {
  Curve curve;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = 0.5 + 0.8 * static_cast<double>(i) / static_cast<double>(count - 1);
    CurvePoint point;
    point.point = {60 * std::cos(t), 60 * std::sin(t), 40};
    point.direction = {0.5 * std::cos(t), 0.5 * std::sin(t), std::sqrt(0.75)};
    point.feed = 10;
    curve.points.push_back(point);
  }
  return curve;
}

Eigen::Vector3d tip(const Machine& machine, const ToolPathStep& step) {
  return nominal_workpiece_from_tool(machine, std::span(step.command).first(machine.axes.size())).translation;
}

TEST(ToolPath, MeetsEveryPointAndKeepsItsFeedAndDwell) {
  const Machine machine = test::yin_engraver('U');
  Curve curve = arc(9);
  curve.points[0].dwell = 0.25;
  const ToolPath path = plan_tool_path(machine, curve);
  ASSERT_EQ(path.status, ToolPathStatus::followed) << path.message;
  ASSERT_EQ(path.steps.size(), 9U);
  double length = 0;
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_EQ(path.steps[i].point, i);
    EXPECT_LT((tip(machine, path.steps[i]) - curve.points[i].point).norm(), 1e-10);
    EXPECT_EQ(path.steps[i].working, i > 0);  // there is no way to the first point
    if (i > 0) length += (curve.points[i].point - curve.points[i - 1].point).norm();
  }
  EXPECT_NEAR(path.working_length, length, 1e-12);
  EXPECT_NEAR(path.working_time, length / 10 + 0.25, 1e-12);
  EXPECT_EQ(path.steps[0].dwell, 0.25);
  EXPECT_LT(largest_miss(machine, curve, path).distance, 1e-10);
  curve.points[3].point.x() += 0.5;
  EXPECT_NEAR(largest_miss(machine, curve, path).distance, 0.5, 1e-10);
  EXPECT_LT(largest_miss(machine, curve, path).angle, 1e-6);
}

TEST(ToolPath, PosesAreInsertedUntilTheToolStaysNearTheLines) {
  const Machine machine = test::yin_engraver('U');
  const Curve curve = arc(5);
  const ToolPath coarse = plan_tool_path(machine, curve);
  EXPECT_GT(coarse.largest_deviation, 0.1);
  ToolPathOptions options;
  options.tolerance = 1e-3;
  const ToolPath fine = plan_tool_path(machine, curve, options);
  ASSERT_EQ(fine.status, ToolPathStatus::followed);
  EXPECT_GT(fine.inserted, 10U);
  EXPECT_LE(fine.largest_deviation, 1e-3);
  EXPECT_NEAR(fine.working_length, coarse.working_length, 1e-9);
  // On the way as a control goes it, at places that the planner did not look at.
  double largest = 0;
  for (std::size_t i = 1; i < fine.steps.size(); ++i) {
    const Eigen::Vector3d from = tip(machine, fine.steps[i - 1]), to = tip(machine, fine.steps[i]);
    for (const double t : {0.1, 0.37, 0.61, 0.9}) {
      ToolPathStep between = fine.steps[i];
      for (std::size_t k = 0; k < machine.axes.size(); ++k) {
        between.command[k] = (1 - t) * fine.steps[i - 1].command[k] + t * fine.steps[i].command[k];
      }
      const Eigen::Vector3d chord = (to - from).normalized();
      largest = std::max(largest, (tip(machine, between) - from).cross(chord).norm());
    }
  }
  EXPECT_LE(largest, 1.01e-3);
  EXPECT_GT(largest, 1e-4);
  options.largest_count = 8;
  EXPECT_EQ(plan_tool_path(machine, curve, options).status, ToolPathStatus::too_many_poses);
}

TEST(ToolPath, RegionsAreIndexedWithTheToolRetracted) {
  const Machine machine = test::yin_engraver('U');
  const std::size_t c2 = machine.find_axis("C2");
  Curve curve = arc(8);
  curve.indexed = {c2};
  for (std::size_t i = 0; i < 8; ++i) curve.points[i].indexed = {i < 4 ? 0.0 : 20 * kDegree};
  EXPECT_EQ(plan_tool_path(machine, curve).status, ToolPathStatus::no_retract);
  ToolPathOptions options;
  options.retract = 25;
  const ToolPath path = plan_tool_path(machine, curve, options);
  ASSERT_EQ(path.status, ToolPathStatus::followed) << path.message;
  EXPECT_EQ(path.regions, 2U);
  ASSERT_EQ(path.steps.size(), 12U);
  for (std::size_t i = 0; i < 12; ++i) {
    const ToolPathStep& step = path.steps[i];
    EXPECT_EQ(step.command[c2], i < 6 ? 0.0 : 20 * kDegree);
    const std::size_t in_region = i % 6;
    EXPECT_EQ(step.working, in_region >= 2 && in_region <= 4) << i;
    const bool retracted = in_region == 0 || in_region == 5;
    EXPECT_EQ(step.point == ToolPathStep::kNoPoint, retracted);
    if (!retracted) {
      EXPECT_LT((tip(machine, step) - curve.points[step.point].point).norm(), 1e-10);
    } else {
      const CurvePoint& near = curve.points[i == 0 ? 0 : i == 5 ? 3 : i == 6 ? 4 : 7];
      EXPECT_LT((tip(machine, step) - near.point - 25 * near.direction).norm(), 1e-10);
    }
  }
}

TEST(ToolPath, OnTheWorkpieceItLeavesWhatItWorksOnWithinARegion) {
  Curve curve = arc(12);
  EXPECT_EQ(working_runs(curve).size(), 1U);
  EXPECT_EQ(working_runs(curve)[0].last, 11U);
  const Machine machine = test::yin_engraver('U');
  curve.indexed = {machine.find_axis("C2")};
  for (CurvePoint& point : curve.points) point.indexed = {0};
  for (std::size_t i = 6; i < 12; ++i) curve.points[i].indexed = {1};  // the tool retracts on the way to the seventh
  for (const std::size_t rapid : {3U, 9U, 10U, 11U}) curve.points[rapid].working = false;
  const std::vector<WorkingRun> runs = working_runs(curve);
  ASSERT_EQ(runs.size(), 3U);
  const std::size_t expected[][2] = {{0, 2}, {3, 5}, {6, 8}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(runs[i].first, expected[i][0]);
    EXPECT_EQ(runs[i].last, expected[i][1]);
  }
  // The planned path agrees: a move at work ends at each point of a run but its first.
  std::size_t working = 0;
  ToolPathOptions options;
  options.retract = 5;
  const ToolPath path = plan_tool_path(machine, curve, options);
  ASSERT_EQ(path.status, ToolPathStatus::followed) << path.message;
  for (const ToolPathStep& step : path.steps) working += step.working ? 1 : 0;
  EXPECT_EQ(working, 6U);
  for (CurvePoint& point : curve.points) point.working = false;
  EXPECT_TRUE(working_runs(curve).empty());
  EXPECT_TRUE(working_runs(Curve{}).empty());
}

TEST(ToolPath, SaysWhichPointCannotBeReached) {
  Machine machine = test::yin_engraver('U');
  const Curve curve = arc(6);
  const ToolPath free = plan_tool_path(machine, curve);
  ASSERT_EQ(free.status, ToolPathStatus::followed);
  // A travel of A that ends before the tilt of 30 degrees.
  Axis& a = machine.axes[machine.find_axis("A")];
  a.travel_min = -0.4, a.travel_max = 0.4;
  const ToolPath path = plan_tool_path(machine, curve);
  EXPECT_EQ(path.status, ToolPathStatus::outside_travel);
  EXPECT_EQ(path.failed_point, 0U);
  EXPECT_NE(path.message.find('A'), std::string::npos) << path.message;
  EXPECT_EQ(plan_tool_path(machine, {}).status, ToolPathStatus::invalid_options);
}

TEST(ToolPath, AJumpAtWorkIsSaid) {
  // The tool passes through the vertical, sideways: C1 has to turn by half a turn there, or A to pass through zero.
  Machine machine = test::yin_engraver('U');
  Axis& a = machine.axes[machine.find_axis("A")];
  a.travel_min = 0;
  Curve curve;
  for (const double tilt : {-10.0, -5.0, 5.0, 10.0}) {
    CurvePoint point;
    point.point = {10 * tilt, 0, 40};
    point.direction = {std::sin(tilt * kDegree), 0, std::cos(tilt * kDegree)};
    point.feed = 10;
    curve.points.push_back(point);
  }
  const ToolPath path = plan_tool_path(machine, curve);
  ASSERT_EQ(path.status, ToolPathStatus::jumps_while_working) << path.message;
  ASSERT_EQ(path.working_jumps.size(), 1U);
  EXPECT_EQ(path.working_jumps[0], 2U);
  a.travel_min = -1;
  EXPECT_EQ(plan_tool_path(machine, curve).status, ToolPathStatus::followed);
}

TEST(Placement, AnglesAreThoseOfTheRotationAlsoWhereOneIsFree) {
  for (const Eigen::Vector3d& angles : {Eigen::Vector3d(0.3, -0.7, 2.5), Eigen::Vector3d(-3, 1.2, -0.1)}) {
    EXPECT_LT((angles_xyz(rotation_xyz(angles)) - angles).norm(), 1e-14);
  }
  const Eigen::Matrix3d locked = rotation_xyz({0.4, std::numbers::pi / 2, 0.5});
  const Eigen::Vector3d found = angles_xyz(locked);
  EXPECT_EQ(found.x(), 0);
  EXPECT_LT((rotation_xyz(found) - locked).norm(), 1e-12);
}

}  // namespace
}  // namespace abbe
