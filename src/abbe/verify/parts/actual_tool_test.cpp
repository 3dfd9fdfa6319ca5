#include "abbe/verify/parts/actual_tool.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "abbe/compensate/program/errors_for_test.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

TEST(ActualTools, IsWhereTheChainOfOnePoseHasIt) {
  for (const auto& [name, machine] : test::all_machines()) {
    const ErrorSet errors = test::tens_of_micrometres(machine, 3);
    std::mt19937_64 generator(5);
    PoseList commands;
    for (int k = 0; k < 20; ++k) commands.append(test::random_commands(machine, generator));
    const ToolPlaces tool = actual_tool(machine, errors, commands);
    for (std::size_t k = 0; k < commands.count(); ++k) {
      const RigidTransform pose = actual_workpiece_from_tool(machine, errors, commands.pose(k));
      const auto column = static_cast<Eigen::Index>(k);
      EXPECT_LT((tool.point.col(column) - pose.translation).norm(), 1e-9) << name;
      EXPECT_LT((tool.direction.col(column) - pose.rotation * machine.tool_direction).norm(), 1e-12) << name;
    }
  }
}

TEST(ActualTools, ReversalValuesActWhereTheApproachIsKnown) {
  const Machine machine = test::trunnion_mill();
  const std::size_t x = machine.find_axis("X");
  ErrorSet errors;
  errors.reversals = {{x, -0.02, 0}};
  PoseList commands;
  commands.append({0.3, -0.4, 20, 30, -40});
  const Eigen::Vector3d unknown = actual_tool(machine, errors, commands).point.col(0);
  commands.approach.assign(5, {1});
  const Eigen::Vector3d forward = actual_tool(machine, errors, commands).point.col(0);
  commands.approach.assign(5, {-1});
  const Eigen::Vector3d backward = actual_tool(machine, errors, commands).point.col(0);
  EXPECT_NEAR((forward - backward).norm(), 0.02, 1e-12);
  EXPECT_LT((forward + backward - 2 * unknown).norm(), 1e-12);
}

TEST(ActualTools, RefusesCommandsOfAnotherMachine) {
  EXPECT_THROW(actual_tool(test::trunnion_mill(), ErrorSet{}, PoseList{{{0}, {0}, {0}}}), std::invalid_argument);
}

/// One axis to and fro: up to 1 mm, down to -0.5 mm, in steps of 0.01 mm.
std::vector<double> to_and_fro() {
  std::vector<double> commands;
  for (int k = 0; k <= 100; ++k) commands.push_back(0.01 * k);
  for (int k = 1; k <= 150; ++k) commands.push_back(1 - 0.01 * k);
  return commands;
}

TEST(Play, EndsEveryMotionWhereTheReversalValueHasIt) {
  for (const double value : {-0.05, 0.05}) {
    ErrorSet errors;
    errors.reversals = {{1, value, 0}};
    PoseList commands;
    commands.axis = {to_and_fro(), to_and_fro()};
    const PoseList positions = positions_with_play(errors, commands);
    EXPECT_EQ(positions.axis[0], commands.axis[0]);
    const std::vector<double>& y = positions.axis[1];
    EXPECT_DOUBLE_EQ(y.front(), 0);
    for (std::size_t k = 0; k < y.size(); ++k) {
      const double since = k <= 100 ? commands.axis[1][k] : 1 - commands.axis[1][k];  // way since the last reversal
      const double approach = k <= 100 ? 1 : -1;
      if (since > (k <= 100 ? 0.026 : 0.051)) {
        EXPECT_NEAR(y[k], commands.axis[1][k] + approach * value / 2, 1e-12) << k;
      }
      // On the way there it stays between what both directions would give.
      EXPECT_LE(std::abs(y[k] - commands.axis[1][k]), std::abs(value) / 2 + 1e-12);
    }
  }
}

TEST(Play, AnAxisWithLostMotionRestsWhileItsCommandTurnsBack) {
  ErrorSet errors;
  errors.reversals = {{0, -0.05, 0}};
  PoseList commands;
  commands.axis = {to_and_fro()};
  const std::vector<double> y = positions_with_play(errors, commands).axis[0];
  for (std::size_t k = 101; k <= 105; ++k) EXPECT_NEAR(y[k], 1 - 0.025, 1e-12);
  EXPECT_LT(y[106], 1 - 0.026);
}

TEST(Play, NothingHappensWithoutReversalValuesOrSamples) {
  ErrorSet errors;
  errors.reversals = {{0, -0.05, 0}};
  PoseList nothing;
  nothing.axis = {{}};
  EXPECT_EQ(positions_with_play(errors, nothing).count(), 0u);
  PoseList commands;
  commands.axis = {to_and_fro()};
  EXPECT_EQ(positions_with_play(ErrorSet{}, commands).axis, commands.axis);
}

}  // namespace
}  // namespace abbe
