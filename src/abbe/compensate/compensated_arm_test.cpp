#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "abbe/compensate/compensated_inverse.h"
#include "abbe/compensate/corrected_poses.h"
#include "abbe/compensate/program/errors_for_test.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/inverse_kinematics.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

std::vector<Machine> arms() {
  return {test::jointed_arm(), test::parallel_axes_arm(), test::seven_axis_arm(), test::coupled_arm(),
          test::coupled_seven_axis_arm()};
}

/// Smallest singularity margin of the working axes at a pose, by the nominal inverse kinematics.
double margin_at(const Machine& machine, const std::vector<double>& commands) {
  const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
  const InverseResult result = InverseKinematics(machine).solve(PoseTarget::at(pose), commands);
  return result.solutions.empty() ? 0 : result.solutions.front().singular_margin;
}

double missed_turn(const RigidTransform& a, const RigidTransform& b) {
  return rotation_vector(a.rotation * b.rotation.transpose()).norm();
}

PoseList inner_poses(const Machine& machine, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  PoseList poses;
  poses.axis.resize(machine.axes.size());
  for (std::size_t k = 0; k < count; ++k) {
    const std::vector<double> commands = test::inner_commands(machine, generator);
    for (std::size_t i = 0; i < commands.size(); ++i) poses.axis[i].push_back(commands[i]);
  }
  return poses;
}

TEST(CompensatedArm, EveryPoseAwayFromSingularitiesIsReachedWhole) {
  for (const Machine& machine : arms()) {
    SCOPED_TRACE(machine.name);
    const ErrorSet errors = test::tens_of_micrometres(machine, 3);
    const PoseList poses = inner_poses(machine, 300, 5);
    const CorrectedPoses corrected = corrected_poses(machine, errors, {}, poses);
    int regular = 0;
    for (std::size_t k = 0; k < poses.count(); ++k) {
      const RigidTransform wanted = nominal_workpiece_from_tool(machine, poses.pose(k));
      const RigidTransform after = actual_workpiece_from_tool(machine, errors, corrected.commands.pose(k));
      EXPECT_NEAR(corrected.position_left[k], (after.translation - wanted.translation).norm(), 1e-10);
      EXPECT_NEAR(corrected.orientation_left[k], missed_turn(wanted, after), 1e-12);
      if (corrected.status[k] == CorrectionStatus::reached) {
        EXPECT_LE((after.translation - wanted.translation).norm(), 1e-6);
        EXPECT_LE(missed_turn(wanted, after), 1e-9);
      }
      // The margin is one of positions; commands of coupled axes turn by more than these, and their turn is bounded.
      if (margin_at(machine, poses.pose(k)) < (machine.couplings.empty() ? 0.02 : 0.04)) continue;
      ++regular;
      EXPECT_EQ(corrected.status[k], CorrectionStatus::reached) << k;
    }
    EXPECT_GE(regular, 150);
  }
}

TEST(CompensatedArm, AnAxisThatIsCoupledToOneThatMovesCannotKeepItsCommandAlone) {
  const Machine machine = test::coupled_arm();
  const std::size_t b1 = machine.find_axis("B1"), b2 = machine.find_axis("B2");
  const std::size_t alone[] = {b2}, both[] = {b1, b2};
  EXPECT_EQ(CompensatedInverse(machine, {}, {}, alone).problem(),
            "B2 cannot be held alone: it is coupled to B1; hold B1 too");
  EXPECT_EQ(CompensatedInverse(machine, {}, {}, both).problem(), "");
}

/// A rotary axis that turns with a linear one: neither can be found before the other.
TEST(CompensatedArm, ARotaryAxisThatIsCoupledToALinearOneIsFoundTogetherWithIt) {
  Machine machine = test::coupled_fork_head();
  machine.couplings = {{machine.find_axis("A"), machine.find_axis("Z"), 2e-4}};
  const ErrorSet errors = test::tens_of_micrometres(machine, 3);
  const PoseList poses = inner_poses(machine, 100, 5);
  const CorrectedPoses corrected = corrected_poses(machine, errors, {}, poses);
  int reached = 0;
  for (std::size_t k = 0; k < poses.count(); ++k) {
    if (corrected.status[k] != CorrectionStatus::reached) continue;
    ++reached;
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, poses.pose(k));
    const RigidTransform after = actual_workpiece_from_tool(machine, errors, corrected.commands.pose(k));
    EXPECT_LE((after.translation - wanted.translation).norm(), 1e-6);
    EXPECT_LE(1 - (after.rotation * machine.tool_direction).dot(wanted.rotation * machine.tool_direction), 1e-15);
  }
  EXPECT_GE(reached, 80);
}

TEST(CompensatedArm, NearAWristSingularityThePointIsReachedAndTheTurnBounded) {
  const Machine machine = test::jointed_arm();
  const ErrorSet errors = test::tens_of_micrometres(machine, 7);
  PoseList poses;
  // B3 at zero: A1 and A2 on one line.
  for (const double command : {0.3, 0.2, -0.4, 0.5, 0.0, 0.1}) poses.axis.push_back({command});
  const CorrectedPoses corrected = corrected_poses(machine, errors, {}, poses);
  EXPECT_EQ(corrected.status[0], CorrectionStatus::turn_limited);
  EXPECT_LE(corrected.position_left[0], 1e-8);
  EXPECT_GT(corrected.orientation_left[0], 1e-9);
  double turned = 0;
  for (std::size_t i = 0; i < 6; ++i) turned = std::hypot(turned, corrected.commands.axis[i][0] - poses.axis[i][0]);
  EXPECT_LE(turned, kLargestTurnOfArm * 1.001);
}

TEST(CompensatedArm, FromAnyStartATargetIsReachedOnTheNearestBranch) {
  for (const Machine& machine : arms()) {
    SCOPED_TRACE(machine.name);
    const ErrorSet errors = test::tens_of_micrometres(machine, 11);
    CorrectionOptions options;
    options.target = TargetKind::full_pose;
    options.largest_turn = kLargestTurnOfArm;
    const CompensatedInverse inverse(machine, errors, options);
    const PoseList poses = inner_poses(machine, 60, 13);
    int reached = 0;
    for (std::size_t k = 0; k < poses.count(); ++k) {
      std::vector<double> start = poses.pose(k);
      if (margin_at(machine, start) < 0.02) continue;
      const RigidTransform wanted = nominal_workpiece_from_tool(machine, start);
      for (std::size_t i = 0; i < start.size(); ++i) start[i] += i % 2 == 0 ? 0.02 : -0.02;
      if (machine.axes.size() == 7) start = poses.pose(k);  // what is held decides what can be reached
      std::vector<const double*> in;
      std::vector<double*> out;
      std::vector<double> commands = start;
      for (std::size_t i = 0; i < start.size(); ++i) {
        in.push_back(&start[i]);
        out.push_back(&commands[i]);
      }
      const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation = wanted.rotation;
      TargetArrays target{{&wanted.translation[0], &wanted.translation[1], &wanted.translation[2]}, {}, {}};
      for (std::size_t i = 0; i < 9; ++i) target.rotation[i] = rotation.data() + i;
      CorrectionStatus status{};
      inverse.reach({in, 1}, target, {out, &status, nullptr, nullptr});
      const RigidTransform after = actual_workpiece_from_tool(machine, errors, commands);
      EXPECT_EQ(status, CorrectionStatus::reached) << k;
      EXPECT_LE((after.translation - wanted.translation).norm(), 1e-6);
      EXPECT_LE(missed_turn(wanted, after), 1e-9);
      for (std::size_t i = 0; i < start.size(); ++i) EXPECT_NEAR(commands[i], poses.axis[i][k], 0.02) << i;
      ++reached;
    }
    EXPECT_GE(reached, 20);
  }
}

}  // namespace
}  // namespace abbe
