#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "abbe/compensate/arms_for_test.h"
#include "abbe/compensate/compensated_inverse.h"
#include "abbe/compensate/corrected_poses.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/inverse_kinematics.h"

// Every pose of an arm with errors and compliance that is far enough from singularities is reached, and the status of
// the others is true. Both conditions of docs/compensation.md, "Arms", with e the error of the tool.

namespace abbe {
namespace {

constexpr double kPointReached = 1e-6, kTurnReached = 1e-8;  // mm, rad

struct Left {
  double point, turn;
  bool reached() const { return point <= kPointReached && turn <= kTurnReached; }
};

Left left_at(const Machine& machine, const ErrorSet& errors, const std::vector<double>& commands,
             const RigidTransform& wanted) {
  const RigidTransform actual = actual_workpiece_from_tool(machine, errors, commands);
  return {(actual.translation - wanted.translation).norm(),
          rotation_vector(actual.rotation * wanted.rotation.transpose()).norm()};
}

/// |(shift / size, turn)| of the tool by the errors.
double error_size(const test::ArmWithErrors& arm, const std::vector<double>& commands) {
  Deviation deviation;
  EXPECT_EQ(tool_deviation(arm.machine, arm.errors, commands, deviation), PoseStatus::ok);
  return std::hypot(deviation.head<3>().norm() / arm.size, deviation.tail<3>().norm());
}

bool is_far_from_singularities(double margin, double error) {
  return margin >= 2 * error / kLargestTurnOfArm && margin >= 1.5 * std::sqrt(error);
}

bool is_within_travel(const Machine& machine, const std::vector<double>& commands) {
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const Axis& axis = machine.axes[i];
    if (!axis.endless && !(commands[i] >= axis.travel_min && commands[i] <= axis.travel_max)) return false;
  }
  return true;
}

/// A second route to the commands of an arm with six rotary axes: Newton's method without any bound, with derivatives
/// by differences of the pose.
std::vector<double> unbounded(const Machine& machine, const ErrorSet& errors, std::vector<double> commands,
                              const RigidTransform& wanted) {
  for (int round = 0; round < 7; ++round) {
    const auto missing = [&](const std::vector<double>& at) {
      const RigidTransform actual = actual_workpiece_from_tool(machine, errors, at);
      Eigen::Matrix<double, 6, 1> m;
      m << wanted.translation - actual.translation, rotation_vector(wanted.rotation * actual.rotation.transpose());
      return m;
    };
    const Eigen::Matrix<double, 6, 1> here = missing(commands);
    Eigen::Matrix<double, 6, 6> slope;
    for (std::size_t i = 0; i < 6; ++i) {
      std::vector<double> beside = commands;
      beside[i] += 1e-6;
      slope.col(static_cast<Eigen::Index>(i)) = (here - missing(beside)) / 1e-6;
    }
    const Eigen::Matrix<double, 6, 1> step = slope.fullPivLu().solve(here);
    for (std::size_t i = 0; i < 6; ++i) commands[i] += step[static_cast<Eigen::Index>(i)];
  }
  return commands;
}

/// What a status promises of the commands it stands beside.
void expect_true_status(CorrectionStatus status, const Left& left, const Machine& machine,
                        const std::vector<double>& commands, const std::vector<double>& nominal) {
  EXPECT_TRUE(is_within_travel(machine, commands)) << correction_status_text(status);
  if (status == CorrectionStatus::reached) {
    EXPECT_TRUE(left.reached()) << left.point << ' ' << left.turn;
  }
  if (reaches_point(status)) {
    EXPECT_LE(left.point, kPointReached);
  }
  if (status == CorrectionStatus::not_converged) {
    EXPECT_EQ(commands, nominal);
  }
  if (!reaches_point(status)) {
    EXPECT_GT(left.point + left.turn, 1e-9);
  }
}

TEST(ArmReach, EveryPoseFarFromSingularitiesIsReachedWithErrorsAndCompliance) {
  std::mt19937_64 generator(1);
  std::size_t far = 0, reached_near = 0, near = 0;
  for (const test::ArmWithErrors& arm : test::arms_with_errors()) {
    SCOPED_TRACE(arm.name);
    PoseList poses;
    for (int k = 0; k < 400; ++k) poses.append(test::inner_commands(arm.machine, generator));
    const CorrectedPoses corrected = corrected_poses(arm.machine, arm.errors, {}, poses);
    ASSERT_EQ(corrected.problem, "");
    const InverseKinematics inverse(arm.machine);
    std::size_t here = 0;
    for (std::size_t k = 0; k < poses.count(); ++k) {
      const std::vector<double> nominal = poses.pose(k), commands = corrected.commands.pose(k);
      const Left left = left_at(arm.machine, arm.errors, commands, nominal_workpiece_from_tool(arm.machine, nominal));
      EXPECT_NEAR(corrected.position_left[k], left.point, 1e-9);
      EXPECT_NEAR(corrected.orientation_left[k], left.turn, 1e-11);
      expect_true_status(corrected.status[k], left, arm.machine, commands, nominal);
      if (is_far_from_singularities(test::margin_at(inverse, nominal), error_size(arm, nominal))) {
        if (corrected.status[k] == CorrectionStatus::outside_travel) continue;  // the next test
        ++here;
        EXPECT_TRUE(left.reached()) << k << ": " << correction_status_text(corrected.status[k]) << ", " << left.point;
      } else {
        ++near;
        if (left.reached()) ++reached_near;
      }
    }
    EXPECT_GE(here, 40U);
    far += here;
  }
  EXPECT_GE(far, 4000U);
  RecordProperty("far", static_cast<int>(far));
  RecordProperty("near", static_cast<int>(near));
  RecordProperty("reached_near", static_cast<int>(reached_near));
}

// Commands within 1 mrad of ends of travel, where corrections lead out of it as often as not.
TEST(ArmReach, AtTravelEndsOnlyWhatTheTravelForbidsIsNotReached) {
  std::mt19937_64 generator(2);
  std::size_t reached = 0, forbidden = 0;
  for (const test::ArmWithErrors& arm : test::arms_with_errors()) {
    if (arm.machine.axes.size() != 6) continue;
    SCOPED_TRACE(arm.name);
    PoseList poses;
    for (int k = 0; k < 300; ++k) {
      std::vector<double> commands = test::inner_commands(arm.machine, generator);
      for (int ends = 0; ends <= k % 3; ++ends) {
        const auto i = static_cast<std::size_t>(generator() % 6);
        const double inside = std::uniform_real_distribution<double>(0, 1e-3)(generator);
        const Axis& axis = arm.machine.axes[i];
        commands[i] = generator() % 2 == 0 ? axis.travel_min + inside : axis.travel_max - inside;
      }
      poses.append(commands);
    }
    const CorrectedPoses corrected = corrected_poses(arm.machine, arm.errors, {}, poses);
    const InverseKinematics inverse(arm.machine);
    for (std::size_t k = 0; k < poses.count(); ++k) {
      const std::vector<double> nominal = poses.pose(k), commands = corrected.commands.pose(k);
      const RigidTransform wanted = nominal_workpiece_from_tool(arm.machine, nominal);
      const Left left = left_at(arm.machine, arm.errors, commands, wanted);
      expect_true_status(corrected.status[k], left, arm.machine, commands, nominal);
      if (!is_far_from_singularities(test::margin_at(inverse, nominal), error_size(arm, nominal))) continue;
      const std::vector<double> free = unbounded(arm.machine, arm.errors, nominal, wanted);
      ASSERT_TRUE(left_at(arm.machine, arm.errors, free, wanted).reached());
      if (is_within_travel(arm.machine, free)) {
        EXPECT_TRUE(left.reached()) << k << ": " << correction_status_text(corrected.status[k]);
        ++reached;
      } else {
        EXPECT_EQ(corrected.status[k], CorrectionStatus::outside_travel) << k;
        ++forbidden;
      }
    }
  }
  EXPECT_GE(reached, 500U);
  EXPECT_GE(forbidden, 500U);
}

// Targets that the actual arm has at commands within its travel, often at an end of it: they can be reached.
TEST(ArmReach, TargetsOfTheActualArmAreReachedFromFarStarts) {
  std::mt19937_64 generator(3);
  std::size_t asked = 0;
  for (const test::ArmWithErrors& arm : test::arms_with_errors()) {
    const Machine& machine = arm.machine;
    if (machine.axes.size() != 6) continue;
    SCOPED_TRACE(arm.name);
    const CompensatedInverse inverse(machine, arm.errors,
                                     {.target = TargetKind::full_pose, .largest_turn = kLargestTurnOfArm});
    const InverseKinematics nominal(machine);
    for (int k = 0; k < 60; ++k) {
      std::vector<double> there = test::inner_commands(machine, generator);
      if (k % 3 == 0) there[k % 6] = k % 2 == 0 ? machine.axes[k % 6].travel_min : machine.axes[k % 6].travel_max;
      if (!is_far_from_singularities(test::margin_at(nominal, there), error_size(arm, there))) continue;
      const RigidTransform wanted = actual_workpiece_from_tool(machine, arm.errors, there);
      std::vector<double> start = there;
      for (double& command : start) command += std::uniform_real_distribution<double>(-0.02, 0.02)(generator);
      std::vector<double> commands = start;
      std::array<const double*, 6> in;
      std::array<double*, 6> out;
      for (std::size_t i = 0; i < 6; ++i) {
        in[i] = &start[i];
        out[i] = &commands[i];
      }
      const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation = wanted.rotation;
      TargetArrays target{{&wanted.translation[0], &wanted.translation[1], &wanted.translation[2]}, {}, {}};
      for (std::size_t i = 0; i < 9; ++i) target.rotation[i] = rotation.data() + i;
      CorrectionStatus status{};
      inverse.reach({in, 1}, target, {out, &status});
      EXPECT_EQ(status, CorrectionStatus::reached) << k;
      EXPECT_TRUE(left_at(machine, arm.errors, commands, wanted).reached());
      ++asked;
    }
  }
  EXPECT_GE(asked, 300U);
}

TEST(ArmReach, SingularPosesHaveAnHonestStatus) {
  std::size_t points = 0, all = 0;
  for (const test::ArmWithErrors& arm : test::arms_with_errors()) {
    if (arm.machine.name != "jointed arm") continue;
    SCOPED_TRACE(arm.name);
    std::mt19937_64 generator(4);
    PoseList poses;
    for (int k = 0; k < 200; ++k) {
      std::vector<double> commands = test::inner_commands(arm.machine, generator);
      const double off = k % 2 == 0 ? 0 : std::pow(10.0, -1.0 - k % 6);
      if (k % 3 != 1) commands[4] = off;                               // wrist straight
      if (k % 3 != 0) commands[2] = std::atan2(-302, 70) + 0.1 * off;  // arm stretched: the elbow is 70 off the forearm
      poses.append(commands);
    }
    const CorrectedPoses corrected = corrected_poses(arm.machine, arm.errors, {}, poses);
    for (std::size_t k = 0; k < poses.count(); ++k) {
      const std::vector<double> nominal = poses.pose(k), commands = corrected.commands.pose(k);
      const Left left = left_at(arm.machine, arm.errors, commands, nominal_workpiece_from_tool(arm.machine, nominal));
      expect_true_status(corrected.status[k], left, arm.machine, commands, nominal);
      EXPECT_NEAR(corrected.position_left[k], left.point, 1e-9);
      double turned = 0;
      for (std::size_t i = 0; i < 6; ++i) turned = std::hypot(turned, commands[i] - nominal[i]);
      EXPECT_LE(turned, 1.001 * kLargestTurnOfArm);
      points += reaches_point(corrected.status[k]) ? 1 : 0;
      ++all;
    }
  }
  EXPECT_GE(points, all * 4 / 5);
}

TEST(ArmReach, SevenAxesTakeTheShortestWayAndARailStands) {
  for (const test::ArmWithErrors& arm : test::arms_with_errors()) {
    if (arm.machine.axes.size() != 7) continue;
    SCOPED_TRACE(arm.name);
    const bool has_rail = arm.machine.axes[0].kind == AxisKind::linear;
    std::mt19937_64 generator(5);
    PoseList poses;
    for (int k = 0; k < 60; ++k) poses.append(test::inner_commands(arm.machine, generator));
    const CorrectedPoses corrected = corrected_poses(arm.machine, arm.errors, {}, poses);
    int seen = 0;
    for (std::size_t k = 0; k < poses.count(); ++k) {
      if (corrected.status[k] != CorrectionStatus::reached) continue;
      const std::vector<double> nominal = poses.pose(k), commands = corrected.commands.pose(k);
      if (has_rail) {
        EXPECT_EQ(commands[0], nominal[0]);
        continue;
      }
      Deviation deviation;
      Eigen::MatrixXd by_positions;
      tool_deviation(arm.machine, arm.errors, commands, deviation, nullptr, &by_positions);
      const Eigen::VectorXd alone = Eigen::FullPivLU<Eigen::MatrixXd>(by_positions).kernel().col(0).normalized();
      Eigen::VectorXd change(7);
      for (int i = 0; i < 7; ++i)
        change[i] = commands[static_cast<std::size_t>(i)] - nominal[static_cast<std::size_t>(i)];
      EXPECT_LE(std::abs(alone.dot(change)), 1e-4 * change.norm());
      ++seen;
    }
    if (!has_rail) {
      EXPECT_GE(seen, 40);
    }
  }
}

/// Two parallel rotary axes, a quill, and a rotary axis that turns it.
Machine selective_arm() {
  Machine m = test::arm_of_lines({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
                                 {{0, 0, 300}, {250, 0, 300}, {450, 0, 300}, {450, 0, 300}}, {470, 0, 200});
  m.name = "selective arm";
  m.axes[2].name = "Z3";
  m.axes[2].kind = AxisKind::linear;
  m.axes[2].travel_min = -150;
  m.axes[2].travel_max = 0;
  return m;
}

TEST(ArmReach, AnArmThatNeedsAQuillReachesThePointAndTurnsWhatItCan) {
  test::ArmWithErrors arm{"selective arm", selective_arm(), {}, 470};
  arm.errors = test::errors_of_arm(arm.machine, 0.5, false, 9);
  std::mt19937_64 generator(6);
  PoseList poses;
  for (int k = 0; k < 300; ++k) {
    std::vector<double> commands = test::inner_commands(arm.machine, generator);
    commands[1] = (commands[1] < 0 ? -1 : 1) * std::clamp(std::abs(commands[1]), 0.3, 2.8);  // not stretched
    commands[2] = std::clamp(commands[2], -145.0, -5.0);
    commands[0] *= 0.95;
    commands[3] *= 0.95;
    poses.append(commands);
  }
  const CorrectedPoses corrected = corrected_poses(arm.machine, arm.errors, {}, poses);
  ASSERT_EQ(corrected.problem, "");
  for (std::size_t k = 0; k < poses.count(); ++k) {
    const std::vector<double> nominal = poses.pose(k), commands = corrected.commands.pose(k);
    const RigidTransform wanted = nominal_workpiece_from_tool(arm.machine, nominal);
    EXPECT_EQ(corrected.status[k], CorrectionStatus::orientation_left) << k;
    EXPECT_LE(left_at(arm.machine, arm.errors, commands, wanted).point, kPointReached);
    const RigidTransform actual = actual_workpiece_from_tool(arm.machine, arm.errors, commands);
    const Eigen::Vector3d missing = rotation_vector(wanted.rotation * actual.rotation.transpose());
    EXPECT_LE(std::abs(missing.z()), 0.01 * missing.norm());  // what it can turn
    EXPECT_GT(missing.norm(), 1e-6);                          // its tilt stays
  }
}

}  // namespace
}  // namespace abbe
