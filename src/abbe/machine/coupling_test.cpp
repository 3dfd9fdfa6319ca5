#include "abbe/machine/coupling.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/dh_arm.h"
#include "abbe/machine/drawing.h"
#include "abbe/machine/inverse_kinematics.h"
#include "abbe/machine/machine_check.h"
#include "abbe/machine/machines_for_test.h"
#include "abbe/machine/path.h"

namespace abbe {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::HasSubstr;

const Vector3d kX = Vector3d::UnitX(), kY = Vector3d::UnitY(), kZ = Vector3d::UnitZ();

Matrix3d turn(const Vector3d& axis, double angle) { return AngleAxisd(angle, axis).toRotationMatrix(); }

/// An arm of the size of an ABB IRB 2400: its third motor drives the upper arm through a parallelogram, so that the
/// upper arm keeps its angle to the ground while the lower arm swings.
Machine parallelogram_arm() {
  Machine m = test::arm_of_lines(
      {kZ, kY, kY, kX, kY, kX},
      {{0, 0, 615}, {100, 0, 615}, {100, 0, 1320}, {855, 0, 1455}, {855, 0, 1455}, {855, 0, 1455}}, {940, 0, 1455});
  m.couplings = {{2, 1, -1}};
  return m;
}

/// Where it stands, by the angles of its parts to the ground.
RigidTransform parallelogram_pose(const std::vector<double>& m) {
  const Vector3d lower(705 * std::sin(m[1]), 0, 705 * std::cos(m[1]));
  const Matrix3d upper = turn(kY, m[2]), wrist = upper * turn(kX, m[3]) * turn(kY, m[4]) * turn(kX, m[5]);
  const Vector3d in_plane = Vector3d(100, 0, 615) + lower + upper * Vector3d(755, 0, 135) + wrist * Vector3d(85, 0, 0);
  const Matrix3d base = turn(kZ, m[0]);
  return {base * wrist, base * in_plane};
}

std::vector<double> random_numbers(std::size_t count, double size, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform(-size, size);
  std::vector<double> values(count);
  for (double& value : values) value = uniform(generator);
  return values;
}

TEST(Coupling, ParallelogramKeepsTheAngleOfTheUpperArmToTheGround) {
  const Machine machine = parallelogram_arm();
  std::mt19937_64 generator(3);
  for (int k = 0; k < 100; ++k) {
    const std::vector<double> commands = random_numbers(6, 2, generator);
    const RigidTransform wanted = parallelogram_pose(commands), found = nominal_workpiece_from_tool(machine, commands);
    EXPECT_LE((wanted.translation - found.translation).norm(), 1e-11);
    EXPECT_LE((wanted.rotation - found.rotation).norm(), 1e-14);
  }
  Machine apart = machine;
  apart.couplings.clear();
  EXPECT_GT((nominal_workpiece_from_tool(apart, {0, 0.5, 0, 0, 0, 0}).translation -
             parallelogram_pose({0, 0.5, 0, 0, 0, 0}).translation)
                .norm(),
            100);
}

/// Belts of a wrist run round the axes before: joint 5 turns by its motor and a part of motor 4, joint 6 by its own and
/// parts of both.
TEST(Coupling, BeltsOfAWristAddPartsOfTheMotorsBefore) {
  Machine machine = parallelogram_arm();
  const double c54 = 1.0 / 45, c64 = -1.0 / 60, c65 = 0.75;
  machine.couplings = {{5, 4, c65}, {4, 3, c54}, {5, 3, c64}};
  std::mt19937_64 generator(5);
  for (int k = 0; k < 100; ++k) {
    const std::vector<double> m = random_numbers(6, 2, generator);
    const Matrix3d wanted = turn(kZ, m[0]) * turn(kY, m[1] + m[2]) * turn(kX, m[3]) * turn(kY, m[4] + c54 * m[3]) *
                            turn(kX, m[5] + c64 * m[3] + c65 * m[4]);
    EXPECT_LE((nominal_workpiece_from_tool(machine, m).rotation - wanted).norm(), 1e-14);
  }
}

/// A SCARA with a screw that is a spline shaft too: turning it lifts it by its lead.
TEST(Coupling, AScrewThatTurnsLiftsByItsLead) {
  Machine scara = test::single_axis("w b C1 C2 Z C3 t");
  const std::size_t lift = scara.find_axis("Z"), spline = scara.find_axis("C3");
  const double lead = 20;  // mm per turn
  scara.couplings = {{lift, spline, lead / kTurn}};
  scara.axes[spline].endless = false;
  EXPECT_TRUE(find_problems(scara).empty());
  std::vector<double> commands(4, 0.0);
  commands[spline] = kTurn / 4;
  const Vector3d there = nominal_workpiece_from_tool(scara, commands).translation;
  EXPECT_NEAR(there.z() - nominal_workpiece_from_tool(scara, std::vector<double>(4, 0.0)).translation.z(), 5, 1e-12);
}

TEST(Coupling, CommandsComeBackFromPositions) {
  for (const Machine& machine : {test::coupled_arm(), test::coupled_seven_axis_arm(), test::coupled_fork_head()}) {
    const std::size_t n = machine.axes.size();
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
    for (const AxisCoupling& c : machine.couplings)
      matrix(static_cast<Eigen::Index>(c.axis), static_cast<Eigen::Index>(c.of)) = c.ratio;
    std::mt19937_64 generator(7);
    const std::vector<double> commands = random_numbers(n, 3, generator);
    const std::vector<double> positions = positions_of_commands(machine, commands);
    std::vector<double> back(n), slopes = commands;
    commands_of_positions(machine, positions.data(), back.data());
    slopes_by_commands(machine, slopes.data());
    const Eigen::VectorXd m = Eigen::Map<const Eigen::VectorXd>(commands.data(), static_cast<Eigen::Index>(n));
    const Eigen::VectorXd q = matrix * m, g = matrix.transpose() * m;
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(positions[i], q[static_cast<Eigen::Index>(i)], 1e-15);
      EXPECT_NEAR(back[i], commands[i], 4e-15);
      EXPECT_NEAR(slopes[i], g[static_cast<Eigen::Index>(i)], 1e-14);
    }
  }
}

TEST(Coupling, PositionsHaveTheSumOfTheTravels) {
  Machine machine = parallelogram_arm();
  machine.axes[1].travel_min = -1;
  machine.axes[1].travel_max = 2;
  machine.axes[2].travel_min = -0.5;
  machine.axes[2].travel_max = 0.75;
  const PositionLimits limits = position_limits(machine, 2);
  EXPECT_DOUBLE_EQ(limits.from, -2.5);
  EXPECT_DOUBLE_EQ(limits.to, 1.75);
  const PositionLimits commands = commands_within(machine, 2, limits);
  EXPECT_DOUBLE_EQ(commands.from, -0.5);
  EXPECT_DOUBLE_EQ(commands.to, 0.75);
  EXPECT_DOUBLE_EQ(position_limits(machine, 1).to, 2);
}

TEST(Coupling, WhatMakesNoSenseIsRefused) {
  const auto problem = [](const std::vector<AxisCoupling>& couplings, const char* chain = "w C' b X A B t") {
    Machine machine = test::single_axis(chain);
    for (Axis& axis : machine.axes) {
      axis.endless = axis.name == "C";
      if (!axis.endless && axis.kind == AxisKind::rotary) axis.travel_max = 1, axis.travel_min = -1;
    }
    machine.couplings = couplings;
    const std::vector<MachineProblem> found = find_problems(machine);
    return found.empty() ? std::string() : found.front().text();
  };
  // C 0, X 1, A 2, B 3.
  EXPECT_EQ(problem({{3, 2, -1}}), "");
  EXPECT_EQ(problem({{1, 2, 5}}), "");
  EXPECT_THAT(problem({{3, 3, 1}}), HasSubstr("axis B: coupled: is coupled to itself"));
  EXPECT_THAT(problem({{3, 2, 1}, {2, 3, 1}}),
              HasSubstr("axis A: coupled: the couplings go round: each of A, B needs the command of another one"));
  EXPECT_THAT(problem({{1, 3, 1}, {3, 2, 1}, {2, 1, 1}}), HasSubstr("each of X, A, B needs"));
  EXPECT_THAT(problem({{3, 2, 0}}), HasSubstr("the ratio to A is 0"));
  EXPECT_THAT(problem({{3, 2, std::nan("")}}), HasSubstr("the ratio to A is nan"));
  EXPECT_THAT(problem({{3, 2, 1}, {3, 2, 2}}), HasSubstr("is coupled to A twice"));
  EXPECT_THAT(problem({{3, 7, 1}}), HasSubstr("an axis that does not exist"));
  EXPECT_THAT(problem({{2, 0, 1}}), HasSubstr("no drive goes through the bed"));
  EXPECT_THAT(problem({{1, 0, 1}}, "w C' X' b A t"), HasSubstr("C, to which it is coupled, is endless"));
  EXPECT_THAT(problem({{3, 2, 1e6}}), HasSubstr("moves it up to"));
  Machine set = test::coupled_arm();
  set.axes[set.find_axis("B2")].setting = true;
  EXPECT_THAT(find_problems(set).front().text(), HasSubstr("it would not stay where it is set"));
}

TEST(Coupling, WordsAndDrawingSayIt) {
  const Machine machine = test::coupled_arm();
  EXPECT_EQ(first_coupling(machine), "A2 is coupled to B3");
  EXPECT_EQ(position_formula(machine, machine.find_axis("B2")), "B2 = command - 1 B1");
  EXPECT_EQ(position_formula(machine, machine.find_axis("A2")), "A2 = command + 0.5 B3 - 0.03 A1");
  EXPECT_EQ(position_formula(machine, machine.find_axis("B1")), "");
  EXPECT_THAT(position_formula(test::coupled_fork_head(), test::coupled_fork_head().find_axis("Z")),
              HasSubstr("Z = command + 0.05235987756 mm/deg A"));
  EXPECT_THAT(draw_machine(machine), HasSubstr("-110 … 70 deg, coupled"));
}

/// Rows of both conventions with couplings against the matrices of textbooks.
TEST(Coupling, DenavitHartenbergTables) {
  std::mt19937_64 generator(13);
  for (const DhConvention convention : {DhConvention::standard, DhConvention::modified}) {
    DhArm arm;
    arm.convention = convention;
    for (std::size_t i = 0; i < 6; ++i) {
      const std::vector<double> row = random_numbers(4, 1, generator);
      DhJoint joint;
      joint.name = "A" + std::to_string(i + 1);
      joint.a = 300 * row[0];
      joint.alpha = row[1];
      joint.d = 300 * row[2];
      joint.theta = row[3];
      joint.reversed = i % 2 == 1;
      joint.travel_min = -3;
      joint.travel_max = 3;
      arm.joints.push_back(joint);
    }
    arm.couplings = {{2, 1, -1}, {4, 3, 0.1}};
    const Machine machine = machine_from_dh(arm);
    for (int k = 0; k < 20; ++k) {
      const std::vector<double> commands = random_numbers(6, 2, generator);
      std::vector<double> theta(6);
      for (std::size_t i = 0; i < 6; ++i) theta[i] = commands[i];
      theta[2] -= commands[1];
      theta[4] += 0.1 * commands[3];
      Eigen::Matrix4d product = Eigen::Matrix4d::Identity();
      for (std::size_t i = 0; i < 6; ++i) {
        const DhJoint& joint = arm.joints[i];
        const double t = joint.theta + (joint.reversed ? -theta[i] : theta[i]);
        const double ct = std::cos(t), st = std::sin(t), ca = std::cos(joint.alpha), sa = std::sin(joint.alpha);
        Eigen::Matrix4d row;
        if (convention == DhConvention::standard) {
          row << ct, -st * ca, st * sa, joint.a * ct, st, ct * ca, -ct * sa, joint.a * st, 0, sa, ca, joint.d, 0, 0, 0,
              1;
        } else {
          row << ct, -st, 0, joint.a, st * ca, ct * ca, -sa, -joint.d * sa, st * sa, ct * sa, ca, joint.d * ca, 0, 0, 0,
              1;
        }
        product = product * row;
      }
      const RigidTransform found = nominal_workpiece_from_tool(machine, commands), same = dh_pose(arm, commands);
      EXPECT_LE((found.translation - product.topRightCorner<3, 1>()).norm(), 1e-11);
      EXPECT_LE((found.rotation - product.topLeftCorner<3, 3>()).norm(), 1e-13);
      EXPECT_LE((same.translation - product.topRightCorner<3, 1>()).norm(), 1e-11);
    }
  }
}

double missed(const InverseSolution& solution, const std::vector<double>& commands) {
  double worst = 0;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    worst = std::max(worst, std::abs(solution.position[i] - commands[i]));
  }
  return worst;
}

/// All solutions reach the pose; one of them are the commands that it was made from; what exceeds a travel says so.
void round_trip(const Machine& machine, int poses, double margin) {
  InverseOptions options;
  options.all_turns = true;
  const InverseKinematics inverse(machine, options);
  ASSERT_EQ(inverse.problem(), "");
  std::mt19937_64 generator(11);
  int solutions = 0, tried = 0;
  while (tried < poses) {
    const std::vector<double> commands = test::random_commands(machine, generator);
    const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
    const InverseResult result = inverse.solve(PoseTarget::at(pose), commands);
    ASSERT_EQ(result.status, InverseStatus::solved) << tried;
    if (result.solutions.front().singular_margin < margin) continue;  // commands are not known to 1e-9 there
    ++tried;
    double nearest = 1e300;
    for (const InverseSolution& solution : result.solutions) {
      ++solutions;
      const std::span<const double> found(solution.position.data(), commands.size());
      const RigidTransform there = nominal_workpiece_from_tool(machine, found);
      EXPECT_LE((there.translation - pose.translation).norm(), 1e-9);
      EXPECT_LE((there.rotation - pose.rotation).norm(), 1e-12);
      bool within = true;
      for (std::size_t i = 0; i < commands.size(); ++i) {
        const Axis& axis = machine.axes[i];
        within = within && (axis.endless || (found[i] >= axis.travel_min && found[i] <= axis.travel_max));
      }
      EXPECT_EQ(solution.within_travel, within);
      nearest = std::min(nearest, missed(solution, commands));
    }
    EXPECT_LE(nearest, 1e-9) << tried;
  }
  EXPECT_GT(solutions, poses);
}

TEST(Coupling, ThousandPosesOfACoupledArmComeBack) { round_trip(test::coupled_arm(), 1000, 1e-5); }

TEST(Coupling, PosesOfASevenAxisArmComeBackFromTheirStart) { round_trip(test::coupled_seven_axis_arm(), 200, 1e-5); }

TEST(Coupling, PosesOfAForkHeadComeBack) {
  const Machine machine = test::coupled_fork_head();
  const InverseKinematics inverse(machine, {.held = {}, .reference = {}, .all_turns = true});
  std::mt19937_64 generator(17);
  for (int k = 0; k < 300; ++k) {
    const std::vector<double> commands = test::random_commands(machine, generator);
    const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
    const InverseResult result =
        inverse.solve(PoseTarget::at(pose.translation, pose.rotation * machine.tool_direction), commands);
    ASSERT_EQ(result.status, InverseStatus::solved);
    double nearest = 1e300;
    for (const InverseSolution& solution : result.solutions) nearest = std::min(nearest, missed(solution, commands));
    EXPECT_LE(nearest, 1e-8) << k;
  }
}

/// Limits are those of commands: at the same pose the position of the joint may be far beyond them.
TEST(Coupling, TravelsAreThoseOfCommands) {
  Machine machine = parallelogram_arm();
  machine.axes[2].travel_min = -0.2;
  machine.axes[2].travel_max = 0.2;
  const std::vector<double> commands{0.1, 1.2, 0.15, 0.3, 0.7, -0.4};  // the joint stands at 0.15 - 1.2
  const InverseKinematics inverse(machine);
  const InverseResult result = inverse.solve(PoseTarget::at(nominal_workpiece_from_tool(machine, commands)), commands);
  ASSERT_EQ(result.status, InverseStatus::solved);
  EXPECT_LE(missed(result.solutions.front(), commands), 1e-9);
  machine.axes[2].travel_max = 0.1;
  const InverseResult beyond =
      InverseKinematics(machine).solve(PoseTarget::at(nominal_workpiece_from_tool(machine, commands)), commands);
  double excess = 0;
  for (const InverseSolution& solution : beyond.solutions) {
    if (missed(solution, commands) < 1e-9) excess = solution.excess[2];
  }
  EXPECT_NEAR(excess, 0.05, 1e-9);
}

TEST(Coupling, AHeldAxisNeedsThoseThatItIsCoupledTo) {
  const Machine machine = test::coupled_seven_axis_arm();
  const std::size_t b1 = machine.find_axis("B1"), b2 = machine.find_axis("B2");
  const InverseKinematics alone(machine, {.held = {{b2, 0.1}}, .reference = {}});
  EXPECT_EQ(alone.problem(), "B2 cannot be held alone: it is coupled to B1; hold B1 too");
  const InverseKinematics both(machine, {.held = {{b1, 0.3}}, .reference = {}});
  std::vector<double> commands{0.4, 0.3, 0.2, 0.9, -0.5, 0.8, 0.1};
  const InverseResult result = both.solve(PoseTarget::at(nominal_workpiece_from_tool(machine, commands)), commands);
  ASSERT_EQ(result.status, InverseStatus::solved);
  EXPECT_LE(missed(result.solutions.front(), commands), 1e-8);
  EXPECT_EQ(result.solutions.front().position[b1], 0.3);
}

TEST(Coupling, APathOfACoupledArmIsFollowed) {
  const Machine machine = test::coupled_arm();
  std::vector<PoseTarget> path;
  std::vector<double> commands{0.3, 0.2, -0.4, 0.5, 0.6, -0.2};
  const std::vector<double> start = commands;
  std::vector<std::vector<double>> all;
  for (int k = 0; k < 20; ++k) {
    all.push_back(commands);
    path.push_back(PoseTarget::at(nominal_workpiece_from_tool(machine, commands)));
    for (std::size_t i = 0; i < commands.size(); ++i) commands[i] += 0.01 * (static_cast<double>(i) - 2);
  }
  PathOptions options;
  options.start = start;
  const PathResult result = follow_path(machine, path, options);
  ASSERT_EQ(result.status, PathStatus::followed);
  EXPECT_TRUE(result.jumps.empty());
  for (std::size_t k = 0; k < all.size(); ++k) EXPECT_LE(missed(result.solutions[k], all[k]), 1e-8);
}

}  // namespace
}  // namespace abbe
