#include "abbe/compensate/full_pose_inverse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/dh_arm.h"

namespace abbe {
namespace {

DhArm arm_with(const std::vector<std::array<double, 4>>& rows) {
  DhArm arm;
  arm.name = "arm";
  arm.convention = DhConvention::modified;
  for (const auto& row : rows) {
    DhJoint joint;
    joint.name = "A" + std::to_string(arm.joints.size() + 1);
    joint.a = row[0];
    joint.alpha = row[1] * kDegree;
    joint.d = row[2];
    joint.theta = row[3] * kDegree;
    joint.travel_min = -179 * kDegree;
    joint.travel_max = 179 * kDegree;
    arm.joints.push_back(joint);
  }
  return arm;
}

Machine six_axes() {
  return machine_from_dh(arm_with(
      {{0, 0, 400, 0}, {25, -90, 0, -90}, {455, 0, 0, 0}, {35, -90, 420, 0}, {0, 90, 0, 0}, {0, -90, 80, 180}}));
}

/// An elbow out of the plane, as of lightweight arms: no wrist centre, no closed solution.
Machine six_axes_without_wrist_centre() {
  return machine_from_dh(
      arm_with({{0, 0, 160, 0}, {0, 90, 0, 0}, {-425, 0, 0, 0}, {-392, 0, 133, 0}, {0, 90, 100, 0}, {0, -90, 100, 0}}));
}

Machine seven_axes() {
  return machine_from_dh(arm_with({{0, 0, 340, 0},
                                   {0, -90, 0, 0},
                                   {0, 90, 400, 0},
                                   {0, 90, 0, 0},
                                   {0, -90, 400, 0},
                                   {0, -90, 0, 0},
                                   {0, 90, 126, 0}}));
}

/// Every component of every axis, and motions over the turn: together about 1 mm and 1 mrad at the tool.
ErrorSet arm_errors(const Machine& machine, std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  ErrorSet errors;
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    for (const Component component :
         {Component::X, Component::Y, Component::Z, Component::A, Component::B, Component::C}) {
      const double size = is_rotation(component) ? 2e-4 : 0.1;
      errors.locations.push_back({.axis = axis, .component = component, .value = size * normal(generator)});
      ErrorMotion motion;
      motion.axis = axis;
      motion.component = component;
      motion.basis = {.kind = BasisKind::fourier, .order = 1, .from = -4, .to = 4, .period = kTurn};
      motion.coefficients = {0, 0.1 * size * normal(generator), 0.1 * size * normal(generator)};
      errors.motions.push_back(motion);
    }
  }
  errors.tool_offset_error = {0.1, -0.2, 0.3};
  return errors;
}

std::vector<double> random_commands(const Machine& machine, std::mt19937_64& generator) {
  std::vector<double> commands;
  for (const Axis& axis : machine.axes)
    commands.push_back(
        std::uniform_real_distribution<double>(0.97 * axis.travel_min, 0.97 * axis.travel_max)(generator));
  return commands;
}

TEST(FullPoseInverse, ArmsReachTheNominalPoseInEveryBranch) {
  std::mt19937_64 generator(1);
  for (const Machine& machine : {six_axes(), six_axes_without_wrist_centre()}) {
    const ErrorSet errors = arm_errors(machine, generator);
    const FullPoseInverse inverse(machine, errors, {.largest_turn = 0.1});
    ASSERT_EQ(inverse.problem(), "");
    std::size_t branches = 0, reached = 0;
    for (int i = 0; i < 15; ++i) {
      const std::vector<double> commands = random_commands(machine, generator);
      const RigidTransform wanted = nominal_workpiece_from_tool(machine, commands);
      for (const std::vector<double>& branch : arm_branches(machine, wanted).commands) {
        ++branches;
        const FullPoseResult result = inverse.reach(wanted, branch);
        if (result.status == CorrectionStatus::turn_limited || result.status == CorrectionStatus::outside_travel)
          continue;
        ASSERT_EQ(result.status, CorrectionStatus::reached) << i;
        ++reached;
        const RigidTransform actual = actual_workpiece_from_tool(machine, errors, result.commands);
        EXPECT_LE((actual.translation - wanted.translation).norm(), 1e-9);
        EXPECT_LE(rotation_vector(actual.rotation * wanted.rotation.transpose()).norm(), 1e-11);
        for (std::size_t k = 0; k < branch.size(); ++k) EXPECT_LE(std::abs(result.commands[k] - branch[k]), 0.2);
      }
    }
    EXPECT_GE(branches, 50U);
    EXPECT_GE(reached, branches * 9 / 10);
    RecordProperty("branches", static_cast<int>(branches));
    RecordProperty("reached", static_cast<int>(reached));
  }
}

TEST(FullPoseInverse, SevenAxesTakeTheShortestWay) {
  const Machine machine = seven_axes();
  std::mt19937_64 generator(2);
  const ErrorSet errors = arm_errors(machine, generator);
  const FullPoseInverse inverse(machine, errors, {.largest_turn = 0.1});
  std::size_t reached = 0;
  for (int i = 0; i < 100; ++i) {
    const std::vector<double> commands = random_commands(machine, generator);
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, commands);
    const FullPoseResult result = inverse.reach(wanted, commands);
    if (result.status != CorrectionStatus::reached) continue;
    ++reached;
    const RigidTransform actual = actual_workpiece_from_tool(machine, errors, result.commands);
    EXPECT_LE((actual.translation - wanted.translation).norm(), 1e-9);
    // The change is across the motion of the axes that leaves the pose alone.
    Deviation deviation;
    Eigen::MatrixXd by_positions;
    tool_deviation(machine, errors, result.commands, deviation, nullptr, &by_positions);
    const Eigen::VectorXd alone = Eigen::FullPivLU<Eigen::MatrixXd>(by_positions).kernel().col(0).normalized();
    Eigen::VectorXd change(7);
    for (int k = 0; k < 7; ++k)
      change[k] = result.commands[static_cast<std::size_t>(k)] - commands[static_cast<std::size_t>(k)];
    EXPECT_LE(std::abs(alone.dot(change)), 1e-5 * change.norm());
  }
  EXPECT_GE(reached, 95U);
}

TEST(FullPoseInverse, ThePointComesFirstWhereTheWristIsStraight) {
  const Machine machine = six_axes();
  std::mt19937_64 generator(3);
  const ErrorSet errors = arm_errors(machine, generator);
  const FullPoseInverse inverse(machine, errors);
  const std::vector<double> commands = {0.3, -0.4, 0.6, 0.2, 0, 0.1};  // A4 and A6 in one line
  const RigidTransform wanted = nominal_workpiece_from_tool(machine, commands);
  const FullPoseResult result = inverse.reach(wanted, commands);
  EXPECT_EQ(result.status, CorrectionStatus::turn_limited);
  EXPECT_LE(result.position_left, 1e-9);
  EXPECT_GT(result.orientation_left, 1e-6);
  EXPECT_LE(result.orientation_left, 1e-2);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_LE(std::abs(result.commands[k] - commands[k]), 0.03);
}

TEST(FullPoseInverse, WhatCannotBeReachedIsSaid) {
  const Machine machine = six_axes();
  const FullPoseInverse inverse(machine, ErrorSet{});
  const std::vector<double> commands = {0.3, -0.4, 0.6, 0.2, 0.9, 0.1};
  RigidTransform wanted = nominal_workpiece_from_tool(machine, commands);
  EXPECT_EQ(inverse.reach(wanted, commands).status, CorrectionStatus::reached);
  EXPECT_EQ(inverse.reach(wanted, commands).commands, commands);
  wanted.translation.x() += 1e5;
  EXPECT_FALSE(reaches_point(inverse.reach(wanted, commands).status));
  EXPECT_EQ(inverse.reach(wanted, commands).commands, commands);
  wanted.translation.x() = std::nan("");
  EXPECT_EQ(inverse.reach(wanted, commands).status, CorrectionStatus::not_finite);
  ErrorSet narrow;
  ErrorMotion motion;
  motion.axis = 1;
  motion.component = Component::X;
  motion.basis = {.kind = BasisKind::legendre, .order = 1, .from = 0, .to = 1};
  motion.coefficients = {0, 0.1};
  narrow.motions.push_back(motion);
  wanted = nominal_workpiece_from_tool(machine, commands);
  EXPECT_EQ(FullPoseInverse(machine, narrow).reach(wanted, commands).status, CorrectionStatus::not_covered);
  const std::vector<std::size_t> held = {0};
  ErrorSet all = narrow;
  all.motions[0].basis.from = -4;
  const FullPoseResult result = FullPoseInverse(machine, all, {}, held).reach(wanted, commands);
  EXPECT_EQ(result.commands[0], commands[0]);
}

TEST(ArmBranches, FlippedWristAndElbowAreFound) {
  const Machine machine = six_axes();
  std::mt19937_64 generator(5);
  for (int i = 0; i < 10; ++i) {
    std::vector<double> commands = random_commands(machine, generator);
    commands[4] = (commands[4] < 0 ? -1 : 1) * std::clamp(std::abs(commands[4]), 0.1, 2.9);
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, commands);
    const ArmBranches branches = arm_branches(machine, wanted);
    ASSERT_FALSE(branches.is_singular);
    EXPECT_LE(branches.commands.size(), 8U);
    const auto has = [&](const std::vector<double>& sought) {
      return std::any_of(branches.commands.begin(), branches.commands.end(), [&](const std::vector<double>& found) {
        double most = 0;
        for (std::size_t k = 0; k < 6; ++k)
          most = std::max(most, std::abs(std::remainder(found[k] - sought[k], kTurn)));
        return most < 1e-7;
      });
    };
    EXPECT_TRUE(has(commands)) << i;
    // The wrist turned over: (A4 + half a turn, -A5, A6 + half a turn) is the same attitude.
    std::vector<double> flipped = commands;
    flipped[3] += std::numbers::pi;
    flipped[4] = -flipped[4];
    flipped[5] += std::numbers::pi;
    const bool within = std::abs(std::remainder(flipped[3], kTurn)) < 179 * kDegree &&
                        std::abs(std::remainder(flipped[5], kTurn)) < 179 * kDegree;
    if (within) {
      EXPECT_TRUE(has(flipped)) << i;
    }
    for (const std::vector<double>& found : branches.commands) {
      const RigidTransform pose = nominal_workpiece_from_tool(machine, found);
      EXPECT_LE((pose.translation - wanted.translation).norm(), 1e-8);
      EXPECT_LE((pose.rotation - wanted.rotation).norm(), 1e-10);
    }
  }
  // Straight wrist: A4 and A6 count only together.
  EXPECT_TRUE(arm_branches(machine, nominal_workpiece_from_tool(machine, {0.3, -0.4, 0.6, 0.2, 0, 0.1})).is_singular);
}

}  // namespace
}  // namespace abbe
