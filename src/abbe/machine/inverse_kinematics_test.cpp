#include "abbe/machine/inverse_kinematics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/machine_check.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using std::numbers::pi;

PoseTarget target_of(const Machine& machine, const RigidTransform& pose, TargetKind kind) {
  if (kind == TargetKind::full_pose) return PoseTarget::at(pose);
  if (kind == TargetKind::point) return PoseTarget::at(pose.translation);
  return PoseTarget::at(pose.translation, pose.rotation * machine.tool_direction);
}

/// Whether two sets of commands are the same, endless axes up to full turns.
bool same_commands(const Machine& machine, const InverseSolution& solution, const std::vector<double>& commands) {
  for (std::size_t i = 0; i < commands.size(); ++i) {
    double difference = solution.position[i] - commands[i];
    if (machine.axes[i].endless) difference = std::remainder(difference, 2 * pi);
    if (std::abs(difference) > (machine.axes[i].kind == AxisKind::linear ? 1e-7 : 1e-9)) return false;
  }
  return true;
}

class EveryMachine : public testing::TestWithParam<std::size_t> {
 protected:
  const test::NamedMachine named_ = test::all_machines()[GetParam()];
};

TEST_P(EveryMachine, IsSound) {
  for (const MachineProblem& problem : find_problems(named_.machine)) ADD_FAILURE() << problem.text();
}

/// Inverse after forward is the identity: for a target that the machine's own axes determine, the commands come back
/// among the solutions, and every solution is confirmed by the forward kinematics.
TEST_P(EveryMachine, GivesBackTheCommandsOfAPose) {
  const Machine& machine = named_.machine;
  std::mt19937_64 generator(GetParam());
  int compared = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::vector<double> commands = test::random_commands(machine, generator);
    const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
    for (TargetKind kind : {TargetKind::point, TargetKind::point_and_direction, TargetKind::full_pose}) {
      InverseOptions options;
      options.all_turns = true;
      options.reference = commands;  // what is held stands where it stood
      const InverseKinematics inverse(machine, options);
      const PoseTarget target = target_of(machine, pose, kind);
      const InverseResult result = inverse.solve(target, commands);
      ASSERT_EQ(result.status, InverseStatus::solved) << named_.name << ": " << describe(machine, result);
      bool found = false;
      double margin = 1;
      for (const InverseSolution& solution : result.solutions) {
        const std::vector<double> again(solution.position.begin(),
                                        solution.position.begin() + static_cast<std::ptrdiff_t>(commands.size()));
        const RigidTransform reached = nominal_workpiece_from_tool(machine, again);
        EXPECT_LE((reached.translation - pose.translation).norm(), 1e-8);
        if (kind == TargetKind::point_and_direction) {
          EXPECT_LE(((reached.rotation - pose.rotation) * machine.tool_direction).norm(), 1e-9);
        }
        if (kind == TargetKind::full_pose) {
          EXPECT_LE((reached.rotation - pose.rotation).norm(), 1e-9);
        }
        found = found || same_commands(machine, solution, commands);
        margin = std::min({margin, solution.singular_margin, solution.linear_volume});
        EXPECT_EQ(solution.within_travel, describe(machine, solution).find("travel") == std::string::npos);
      }
      if (margin < 1e-3) continue;
      ++compared;
      EXPECT_TRUE(found) << named_.name << " kind " << static_cast<int>(kind) << " pose " << i;
    }
  }
  EXPECT_GT(compared, 2800);
}

INSTANTIATE_TEST_SUITE_P(All, EveryMachine, testing::Range<std::size_t>(0, test::all_machines().size()),
                         [](const auto& machine_info) {
                           std::string name = test::all_machines()[machine_info.param].name;
                           std::replace_if(
                               name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
                           return std::to_string(machine_info.param) + "_" + name;
                         });

/// Chains nobody thought of: directions at random, any order, either side.
TEST(InverseKinematics, InvertsRandomChainsWithThreeLinearAndUpToThreeRotaryAxes) {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 2000; ++i) {
    const int rotary = i % 4;
    std::string letters = std::string("XYZ") + std::string("ABC").substr(0, static_cast<std::size_t>(rotary));
    std::shuffle(letters.begin(), letters.end(), generator);
    const std::size_t workpiece_side = generator() % (letters.size() + 1);
    Machine machine;
    for (std::size_t k = 0; k < letters.size(); ++k) {
      Axis axis;
      axis.name = letters[k];
      axis_kind_from_letter(letters[k], axis.kind);
      axis.side = k < workpiece_side ? ChainSide::workpiece : ChainSide::tool;
      axis.primed = k < workpiece_side && generator() % 2 == 0;
      axis.direction = Eigen::Vector3d(normal(generator), normal(generator), normal(generator)).normalized();
      axis.point = 100 * Eigen::Vector3d(normal(generator), normal(generator), normal(generator));
      axis.travel_max = axis.kind == AxisKind::linear ? 300 : pi;
      axis.travel_min = -axis.travel_max;
      machine.axes.push_back(axis);
    }
    machine.bed_from_workpiece = {rotation_about(Eigen::Vector3d::UnitX(), normal(generator)), {1, 2, 3}};
    machine.tool_offset = {5, -7, 90};
    ASSERT_TRUE(find_problems(machine).empty());
    const std::vector<double> commands = test::random_commands(machine, generator);
    const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
    InverseOptions options;
    options.reference = commands;
    const InverseResult result = InverseKinematics(machine, options).solve(PoseTarget::at(pose), commands);
    ASSERT_FALSE(result.solutions.empty()) << machine.chain() << ": " << describe(machine, result);
    bool found = false;
    for (const InverseSolution& solution : result.solutions) {
      EXPECT_LE(solution.position_residual, 1e-7);
      EXPECT_LE(solution.orientation_residual, 1e-12);
      double largest = 0;
      for (std::size_t k = 0; k < commands.size(); ++k) {
        largest = std::max(largest, std::abs(solution.position[k] - commands[k]));
      }
      found = found || largest < 1e-5;
    }
    EXPECT_TRUE(found) << machine.chain();
  }
}

TEST(InverseKinematics, NamesTheSingularPoseAndHoldsTheFreeAxis) {
  const Machine machine = test::gantry_fork_head();
  const InverseKinematics inverse(machine);
  const std::vector<double> start = {1000, 500, -300, 37 * kDegree, 5 * kDegree};
  const InverseResult result = inverse.solve(PoseTarget::at({900, 600, 900}, {0, 0, 1}), start);
  ASSERT_EQ(result.status, InverseStatus::solved);
  ASSERT_EQ(result.solutions.size(), 1u);
  EXPECT_NEAR(result.solutions[0].position[3], 37 * kDegree, 1e-15);
  EXPECT_NEAR(result.solutions[0].position[4], 0, 1e-15);
  EXPECT_EQ(describe(machine, result.solutions[0]), "tool parallel to C: C is free, held at 37 deg");
}

TEST(InverseKinematics, NamesParallelAxesOfAFullOrientation) {
  const Machine machine = test::three_axis_head();
  const std::vector<double> start = {0, 0, 0, 20 * kDegree, 0, 10 * kDegree};
  const RigidTransform pose = nominal_workpiece_from_tool(machine, {5, 6, 7, 0, 0, 50 * kDegree});
  const InverseResult result = InverseKinematics(machine).solve(PoseTarget::at(pose), start);
  ASSERT_EQ(result.status, InverseStatus::solved);
  EXPECT_EQ(result.solutions[0].singularity, PoseSingularity::axes_parallel);
  EXPECT_NEAR(result.solutions[0].position[3], 20 * kDegree, 1e-15);
  EXPECT_NEAR(result.solutions[0].position[5], 30 * kDegree, 1e-12);
  EXPECT_EQ(describe(machine, result.solutions[0]),
            "first and last rotary axes parallel, only their sum counts: C1 is free, held at 20 deg");
}

TEST(InverseKinematics, SaysByHowMuchAnOrientationIsOutOfReach) {
  const Machine machine = test::nutating_head_mill();
  const InverseKinematics inverse(machine);
  // The head reaches the horizontal; 20 degrees below it is too far.
  const Eigen::Vector3d below(std::cos(20 * kDegree), 0, -std::sin(20 * kDegree));
  const InverseResult result = inverse.solve(PoseTarget::at({0, 0, 300}, below));
  EXPECT_EQ(result.status, InverseStatus::unreachable_orientation);
  EXPECT_TRUE(result.solutions.empty());
  EXPECT_NEAR(result.closest.orientation_residual, 20 * kDegree, 1e-12);
  EXPECT_EQ(describe(machine, result), "unreachable: the rotary axes miss the orientation by 20 deg");
  const InverseResult limit = inverse.solve(PoseTarget::at({0, 0, 300}, {1, 0, 0}));
  ASSERT_FALSE(limit.solutions.empty());
  EXPECT_EQ(limit.solutions[0].singularity, PoseSingularity::limit_of_reach);
  EXPECT_NEAR(limit.solutions[0].position[4], pi, 1e-9);
}

TEST(InverseKinematics, SaysWhichAxisExceedsItsTravelAndByHowMuch) {
  const Machine machine = test::trunnion_mill();
  // Tool 60 degrees towards +Y needs A = +60 or -60 with C half a turn further; only -60 is within -120 ... 30.
  const Eigen::Vector3d direction(0, std::sin(60 * kDegree), std::cos(60 * kDegree));
  const InverseResult result = InverseKinematics(machine).solve(PoseTarget::at({0, 0, 0}, direction));
  ASSERT_EQ(result.status, InverseStatus::solved);
  ASSERT_EQ(result.solutions.size(), 2u);
  EXPECT_TRUE(result.solutions[0].within_travel);
  EXPECT_NEAR(result.solutions[0].position[1], -60 * kDegree, 1e-12);
  EXPECT_FALSE(result.solutions[1].within_travel);
  EXPECT_NEAR(result.solutions[1].excess[1], 30 * kDegree, 1e-12);
  EXPECT_EQ(describe(machine, result.solutions[1]), "A at 60 deg is 30 deg above its travel");
  const InverseResult far = InverseKinematics(machine).solve(PoseTarget::at({500, 0, 0}, {0, 0, 1}));
  EXPECT_EQ(far.status, InverseStatus::outside_travel);
  EXPECT_EQ(describe(machine, far).substr(0, 14), "outside travel");
}

TEST(InverseKinematics, OffersEveryTurnWithinTravelOrTheNearest) {
  const Machine machine = test::gantry_fork_head();  // C -360 ... 360
  const PoseTarget target = PoseTarget::at({2000, 1000, 700}, {0, -std::sin(0.5), std::cos(0.5)});
  InverseOptions options;
  options.all_turns = true;
  const InverseResult all = InverseKinematics(machine, options).solve(target);
  // A = 0.5: C = 0, 360, -360; A = -0.5: C = 180, -180.
  EXPECT_EQ(all.solutions.size(), 5u);
  for (const InverseSolution& solution : all.solutions) EXPECT_TRUE(solution.within_travel);
  const InverseResult nearest = InverseKinematics(machine).solve(target, {2000, 1000, 0, 300 * kDegree, 20 * kDegree});
  ASSERT_EQ(nearest.solutions.size(), 2u);
  EXPECT_NEAR(nearest.solutions[0].position[3], 360 * kDegree, 1e-12);
}

TEST(InverseKinematics, HoldsSettingAxesFirstThenThoseNearestTheWorkpiece) {
  const auto held_names = [](const Machine& machine, TargetKind kind, const InverseOptions& options = {}) {
    std::string names;
    for (const HeldAxis& held : InverseKinematics(machine, options).held_axes(kind)) {
      names += machine.axes[held.axis].name + " ";
    }
    return names;
  };
  EXPECT_EQ(held_names(test::wang_grinder(), TargetKind::point_and_direction), "A ");
  EXPECT_EQ(held_names(test::yin_engraver('U'), TargetKind::point_and_direction), "C2 ");
  EXPECT_EQ(held_names(test::redundant_gantry(), TargetKind::point_and_direction), "C2 X1 ");
  EXPECT_EQ(held_names(test::redundant_gantry(), TargetKind::full_pose), "C2 X1 ");  // C2 and C1 are parallel
  EXPECT_EQ(held_names(test::trunnion_mill(), TargetKind::point_and_direction), "");
  Machine plain = test::wang_grinder();
  for (Axis& axis : plain.axes) axis.setting = false;
  EXPECT_EQ(held_names(plain, TargetKind::point_and_direction), "C ");
  InverseOptions hold_b;
  hold_b.held = {{5, 0.2}};
  EXPECT_EQ(held_names(plain, TargetKind::point_and_direction, hold_b), "B ");
}

TEST(InverseKinematics, HeldAxesStandAtTheCommandOfTheOption) {
  const Machine machine = test::yin_engraver('P');
  InverseOptions options;
  options.held = {{machine.find_axis("C2"), 30 * kDegree}};
  const RigidTransform pose = nominal_workpiece_from_tool(machine, {30 * kDegree, 10, 20, 30, 0.4, -0.6});
  const PoseTarget target = PoseTarget::at(pose.translation, pose.rotation.col(2));
  for (const InverseSolution& solution : InverseKinematics(machine, options).solve(target).solutions) {
    EXPECT_EQ(solution.position[0], 30 * kDegree);
    EXPECT_LE(solution.position_residual, 1e-10);
  }
}

TEST(InverseKinematics, APolarMachineReachesAPointOnTwoBranches) {
  const Machine machine = test::aguado_table();
  InverseOptions options;
  const InverseKinematics inverse(machine, options);
  const InverseResult result = inverse.solve(PoseTarget::at({-200, 300, 450}, {0, 0, 1}));
  ASSERT_EQ(result.solutions.size(), 2u);
  for (const InverseSolution& solution : result.solutions) EXPECT_LE(solution.position_residual, 1e-10);
  // On the axis C is free; the table's offset in Y is compensated by no other axis, so the point must lie on its
  // circle.
  const InverseResult inside = inverse.solve(PoseTarget::at({0, 0, 450}));
  EXPECT_EQ(inside.status, InverseStatus::unreachable_position);
  EXPECT_NEAR(inside.closest.position_residual, 0.20895713340667849, 1e-12);
  Machine centred = machine;
  centred.axes[0].point.y() = centred.bed_from_workpiece.translation.y() = 0;
  const InverseResult on_axis = InverseKinematics(centred).solve(PoseTarget::at({0, 0, 450}), {40 * kDegree, 700, 100});
  ASSERT_EQ(on_axis.status, InverseStatus::solved);
  EXPECT_EQ(describe(centred, on_axis.solutions[0]), "point on the axis of C: C is free, held at 40 deg");
}

TEST(InverseKinematics, SaysWhenAMachineHasTooFewAxes) {
  const Machine machine = test::three_axis_mill();
  const InverseResult tilted = InverseKinematics(machine).solve(PoseTarget::at({0, 0, 100}, {0, 1, 1}));
  EXPECT_EQ(tilted.status, InverseStatus::too_few_axes);
  EXPECT_NEAR(tilted.closest.orientation_residual, 45 * kDegree, 1e-14);
  EXPECT_EQ(describe(machine, tilted), "too few axes for this target: missed by 0 mm and 45 deg");
  const InverseResult aside = InverseKinematics(test::single_axis("w b Z t")).solve(PoseTarget::at({3, 4, 100}));
  EXPECT_EQ(aside.status, InverseStatus::too_few_axes);
  EXPECT_NEAR(aside.closest.position_residual, 5, 1e-12);
  EXPECT_NEAR(aside.closest.position[0], 100, 1e-12);
}

TEST(InverseKinematics, RefusesBadTargetsMachinesAndOptions) {
  const Machine machine = test::trunnion_mill();
  const InverseKinematics inverse(machine);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(inverse.solve(PoseTarget::at({0, nan, 0})).status, InverseStatus::invalid_target);
  EXPECT_EQ(inverse.solve(PoseTarget::at({0, 0, 0}, {0, 0, 0})).status, InverseStatus::invalid_target);
  EXPECT_EQ(inverse.solve(PoseTarget::at(RigidTransform{2 * Eigen::Matrix3d::Identity(), {0, 0, 0}})).status,
            InverseStatus::invalid_target);
  EXPECT_EQ(inverse.solve(PoseTarget::at({0, 0, 0}), {0, 0, nan, 0, 0}).status, InverseStatus::invalid_target);
  InverseOptions not_finite;
  not_finite.reference = {0, nan, 0, 0, 0};
  EXPECT_EQ(InverseKinematics(machine, not_finite).problem(), "a command of the reference position is not finite");
  Machine broken = machine;
  broken.axes[0].direction = {0, 0, 2};
  EXPECT_EQ(InverseKinematics(broken).solve(PoseTarget::at({0, 0, 0})).status, InverseStatus::invalid_machine);
  EXPECT_EQ(InverseKinematics(broken).problem(), "axis C: direction: (0, 0, 2) has length 2, must be 1");
  InverseOptions options;
  options.held = {{9, 0}};
  EXPECT_FALSE(InverseKinematics(machine, options).problem().empty());
  EXPECT_EQ(InverseResult{}.status, InverseStatus::not_run);
}

}  // namespace
}  // namespace abbe
