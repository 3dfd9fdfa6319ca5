#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/inverse_kinematics.h"
#include "abbe/machine/machine_check.h"
#include "abbe/machine/machines_for_test.h"
#include "abbe/machine/six_axis_loop.h"

namespace abbe {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

const Vector3d kX = Vector3d::UnitX(), kY = Vector3d::UnitY(), kZ = Vector3d::UnitZ();

Vector3d random_vector(std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  return {normal(generator), normal(generator), normal(generator)};
}

Machine puma() {
  return test::arm_of_lines(
      {kZ, kY, kY, kX, kY, kX},
      {{0, 0, 0}, {0, 0, 660}, {432, 150, 660}, {452, 150, 660}, {885, 150, 660}, {885, 150, 660}}, {940, 150, 660});
}

/// Offset wrist: the last three axes do not meet (as a Fanuc CRX).
Machine offset_wrist_arm() {
  return test::arm_of_lines({kZ, kY, kY, kX, kY, kX},
                            {{0, 0, 0}, {0, 0, 245}, {0, 0, 955}, {0, 0, 955}, {540, -150, 955}, {540, -150, 955}},
                            {700, -150, 955});
}

/// Every line at random; or three that meet, or are parallel, from the axis `first` on.
enum class Lines { general, meeting, parallel };
Machine random_arm(std::mt19937_64& generator, Lines lines = Lines::general, std::size_t first = 0) {
  std::vector<Vector3d> directions, points;
  for (int i = 0; i < 6; ++i) {
    directions.push_back(random_vector(generator).normalized());
    points.push_back(300 * random_vector(generator));
  }
  for (std::size_t i = first; i < first + 3; ++i) {
    if (lines == Lines::meeting) points[i] = points[first] + 80 * directions[i];
    if (lines == Lines::parallel) directions[i] = i % 2 == 0 ? directions[first] : Vector3d(-directions[first]);
  }
  Machine machine = test::arm_of_lines(directions, points, 300 * random_vector(generator));
  machine.tool_direction = random_vector(generator).normalized();
  return machine;
}

double apart(double a, double b) { return std::abs(std::remainder(a - b, 2 * pi)); }

/// The largest difference of a command from that of the nearest solution, of whole turns apart.
double nearest_to(const InverseResult& result, const std::vector<double>& commands) {
  double nearest = 1e300;
  for (const InverseSolution& solution : result.solutions) {
    double largest = 0;
    for (std::size_t i = 0; i < commands.size(); ++i)
      largest = std::max(largest, apart(solution.position[i], commands[i]));
    nearest = std::min(nearest, largest);
  }
  return nearest;
}

void expect_reached(const Machine& machine, const RigidTransform& pose, const InverseResult& result, TargetKind kind) {
  for (const InverseSolution& solution : result.solutions) {
    const RigidTransform reached =
        nominal_workpiece_from_tool(machine, std::span(solution.position.data(), machine.axes.size()));
    EXPECT_LE((reached.translation - pose.translation).norm(), 1e-8);
    if (kind == TargetKind::full_pose) {
      EXPECT_LE((reached.rotation - pose.rotation).norm(), 1e-9);
    }
    if (kind == TargetKind::point_and_direction) {
      EXPECT_LE(((reached.rotation - pose.rotation) * machine.tool_direction).norm(), 1e-9);
    }
  }
}

/// The commands of a pose come back to 1e-9 rad, and each solution leads to the pose.
/// @return how often so many solutions were found
std::vector<int> round_trips(const Machine& machine, int count, std::uint64_t seed,
                             TargetKind kind = TargetKind::full_pose) {
  std::vector<int> histogram(33);
  std::mt19937_64 generator(seed);
  const InverseKinematics inverse(machine);
  int compared = 0;
  for (int i = 0; i < count; ++i) {
    const std::vector<double> commands = test::random_commands(machine, generator);
    const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
    PoseTarget target = PoseTarget::at(pose);
    if (kind == TargetKind::point) target = PoseTarget::at(pose.translation);
    if (kind == TargetKind::point_and_direction)
      target = PoseTarget::at(pose.translation, pose.rotation * machine.tool_direction);
    const InverseResult result = inverse.solve(target, commands);
    EXPECT_EQ(result.status, InverseStatus::solved)
        << machine.name << " pose " << i << ": " << describe(machine, result);
    expect_reached(machine, pose, result, kind);
    ++histogram[std::min<std::size_t>(result.solutions.size(), 32)];
    double margin = 1;
    for (const InverseSolution& solution : result.solutions) margin = std::min(margin, solution.singular_margin);
    if (margin < 1e-4) continue;
    ++compared;
    EXPECT_LE(nearest_to(result, commands), 1e-9) << machine.name << " pose " << i;
  }
  EXPECT_GE(compared, count * 8 / 10) << machine.name;
  return histogram;
}

TEST(InverseArm, GivesBackTheCommandsOfAPoseOfEveryKindOfArm) {
  for (const Machine& machine :
       {puma(), offset_wrist_arm(), test::jointed_arm(), test::parallel_axes_arm(), test::seven_axis_arm()}) {
    ASSERT_TRUE(find_problems(machine).empty());
    round_trips(machine, 300, 1);
    round_trips(machine, 100, 2, TargetKind::point_and_direction);
    round_trips(machine, 100, 3, TargetKind::point);
  }
}

TEST(InverseArm, GivesBackTheCommandsOfRandomArms) {
  std::mt19937_64 generator(5);
  for (int i = 0; i < 400; ++i) {
    const auto first = static_cast<std::size_t>(i % 4);
    round_trips(random_arm(generator, Lines::meeting, first), 1, static_cast<std::uint64_t>(i));
    round_trips(random_arm(generator, Lines::parallel, first), 1, static_cast<std::uint64_t>(i));
    round_trips(random_arm(generator), 1, static_cast<std::uint64_t>(i));
  }
}

TEST(InverseArm, APumaHasEightBranches) {
  const std::vector<int> histogram = round_trips(puma(), 500, 7);
  EXPECT_EQ(histogram[8], 500);
}

/// R. Manseur, K. Doty, A robot manipulator with 16 real inverse kinematic solution sets, Int. J. Robotics Research 8
/// (1989) 75: lengths a 0.3, 1, 0, 1.5, 0, 0 and d 0, 0, 0.2, 0, 0, 0, twists 90, 1, 90, 1, 90, 0 degrees.
TEST(InverseArm, FindsThePublishedSixteenSolutions) {
  const double a[6] = {300, 1000, 0, 1500, 0, 0}, d[6] = {0, 0, 200, 0, 0, 0};
  const double twist[6] = {pi / 2, kDegree, pi / 2, kDegree, pi / 2, 0};
  std::vector<Vector3d> directions, points;
  RigidTransform frame;
  for (int i = 0; i < 6; ++i) {
    directions.push_back(frame.rotation.col(2));
    points.push_back(frame.translation);
    frame =
        frame * RigidTransform::translate({0, 0, d[i]}) * RigidTransform{rotation_about(kX, twist[i]), {a[i], 0, 0}};
  }
  Machine machine = test::arm_of_lines(directions, points, frame.translation);
  RigidTransform hand;
  hand.rotation << -0.760117, -0.641689, 0.102262, 0.133333, 0, 0.991071, -0.635959, 0.766965, 0.085558;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(hand.rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  hand.rotation = svd.matrixU() * svd.matrixV().transpose();  // printed to six digits
  hand.translation = {-1140.175, 0, 0};
  const RigidTransform pose{hand.rotation * frame.rotation.transpose(), hand.translation};
  const InverseResult result = InverseKinematics(machine).solve(PoseTarget::at(pose));
  EXPECT_EQ(result.status, InverseStatus::solved);
  EXPECT_EQ(result.solutions.size(), 16u);
  expect_reached(machine, pose, result, TargetKind::full_pose);
}

/// Newton's method from many beginnings finds no solution that is missing.
TEST(InverseArm, MissesNoSolutionThatASearchFinds) {
  std::mt19937_64 generator(11);
  std::uniform_real_distribution<double> anywhere(-pi, pi);
  int found_by_search = 0;
  for (int i = 0; i < 60; ++i) {
    const Machine machine = i % 3 == 0   ? random_arm(generator)
                            : i % 3 == 1 ? offset_wrist_arm()
                                         : random_arm(generator, Lines::parallel, static_cast<std::size_t>(i % 4));
    const std::vector<double> commands = test::random_commands(machine, generator);
    const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
    const InverseResult result = InverseKinematics(machine).solve(PoseTarget::at(pose), commands);
    SixAxisLoop loop;
    for (std::size_t k = 0; k < kLoopAxes; ++k) {
      loop.direction[k] = machine.axes[k].direction;
      loop.point[k] = machine.axes[k].point;
    }
    loop.target = pose * RigidTransform::translate(-machine.tool_reference);
    for (int k = 0; k < 200; ++k) {
      LoopAngles angles{};
      for (double& angle : angles) angle = anywhere(generator);
      if (!(polish(loop, machine.tool_reference, loop.size(), angles) < 1e-11)) continue;
      ++found_by_search;
      EXPECT_LE(nearest_to(result, {angles.begin(), angles.end()}), 1e-5) << i;
    }
  }
  EXPECT_GE(found_by_search, 3000);
}

TEST(InverseArm, AnArmWithIdentifiedLengthsHasTheBranchesOfTheIdealOne) {
  std::mt19937_64 generator(13);
  for (Machine machine : {puma(), test::jointed_arm(), test::parallel_axes_arm()}) {
    for (Axis& axis : machine.axes) {
      axis.point += 0.1 * random_vector(generator);
      axis.direction = (axis.direction + 2e-4 * random_vector(generator)).normalized();
    }
    round_trips(machine, 150, 17);
  }
}

TEST(InverseArm, HalfTurnsAreNoSpecialCase) {
  std::mt19937_64 generator(19);
  const std::vector<Machine> machines{puma(), offset_wrist_arm(), random_arm(generator), random_arm(generator)};
  for (const Machine& machine : machines) {
    for (std::size_t i = 0; i < 6; ++i) {
      for (const double command : {pi, -pi, 0.5 * pi, -0.5 * pi}) {
        std::vector<double> commands{0.4, -0.7, 0.9, 0.3, 1.1, -0.2};
        commands[i] = command;
        const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
        const InverseResult result = InverseKinematics(machine).solve(PoseTarget::at(pose), commands);
        EXPECT_EQ(result.status, InverseStatus::solved);
        EXPECT_LE(nearest_to(result, commands), 1e-8) << i << " at " << command;
      }
    }
  }
}

TEST(InverseArm, AFreeAxisOfTheWristIsHeldAtTheStart) {
  const Machine machine = test::jointed_arm();
  const RigidTransform pose = nominal_workpiece_from_tool(machine, {0.3, 0.2, -0.4, 0.9, 0, -0.4});
  const InverseResult result = InverseKinematics(machine).solve(PoseTarget::at(pose), {0.3, 0.2, -0.4, 0.25, 0, 0});
  ASSERT_EQ(result.status, InverseStatus::solved);
  const InverseSolution& nearest = result.solutions.front();
  EXPECT_EQ(nearest.singularity, PoseSingularity::arm_dependent);
  EXPECT_EQ(nearest.singular_axis, machine.find_axis("A1"));
  EXPECT_EQ(nearest.position[3], 0.25);
  EXPECT_NEAR(nearest.position[4], 0, 1e-7);
  EXPECT_NEAR(nearest.position[5], 0.25, 1e-7);
  EXPECT_LE(nearest.singular_margin, 1e-6);
  EXPECT_EQ(describe(machine, nearest), "axes of the arm dependent: A1 is free, held at 14.3239 deg");
}

TEST(InverseArm, AFirstAxisBelowTheWristIsHeldAtTheStart) {
  Machine machine = puma();
  for (std::size_t i = 2; i < 6; ++i) machine.axes[i].point.y() = 0;
  machine.tool_reference.y() = 0;
  // Wrist above axis 1: half of the upper arm's and the forearm's way out and back.
  std::vector<double> commands{0.8, -0.5, 0, 0.4, 0.7, 0.2};
  double low = -3, high = 0;
  const auto out = [&](double elbow) {
    commands[2] = elbow;
    Machine at_wrist = machine;
    at_wrist.tool_reference = machine.axes[5].point;
    const Vector3d p = nominal_workpiece_from_tool(at_wrist, commands).translation;
    return p.x() * std::cos(0.8) + p.y() * std::sin(0.8);
  };
  for (int i = 0; i < 200; ++i) ((out(0.5 * (low + high)) > 0) == (out(low) > 0) ? low : high) = 0.5 * (low + high);
  commands[2] = low;
  ASSERT_NEAR(out(low), 0, 1e-10);
  const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
  std::vector<double> start = commands;
  start[0] = 0.6;
  const InverseResult result = InverseKinematics(machine).solve(PoseTarget::at(pose), start);
  ASSERT_EQ(result.status, InverseStatus::solved);
  EXPECT_EQ(result.solutions.front().singularity, PoseSingularity::arm_dependent);
  EXPECT_EQ(result.solutions.front().singular_axis, 0u);
  EXPECT_EQ(result.solutions.front().position[0], 0.6);
}

TEST(InverseArm, OutOfReachTheOrientationIsKeptAndTheDistanceTheLeast) {
  const Machine machine = puma();
  // The wrist reaches as far from the shoulder's axis as upper arm and forearm together, at the offset of the shoulder.
  RigidTransform pose = nominal_workpiece_from_tool(machine, {0.3, -0.4, 0.5, 0.2, 0.6, -0.3});
  const Vector3d wrist(2000, 0, 660);
  pose.translation = wrist + pose.rotation * (machine.tool_reference - machine.axes[5].point);
  const InverseResult result = InverseKinematics(machine).solve(PoseTarget::at(pose));
  EXPECT_EQ(result.status, InverseStatus::unreachable_position);
  EXPECT_TRUE(result.solutions.empty());
  const double reach = 432 + std::hypot(885 - 432, 0);
  EXPECT_NEAR(result.closest.position_residual, 2000 - std::hypot(reach, 150), 1e-4);
  EXPECT_LE(result.closest.orientation_residual, 1e-9);
  EXPECT_EQ(describe(machine, result).substr(0, 12), "unreachable:");
}

TEST(InverseArm, OfSevenAxesOneIsHeldAtItsCommandOfTheStart) {
  const Machine machine = test::seven_axis_arm();
  const InverseKinematics inverse(machine);
  const std::vector<HeldAxis> held = inverse.held_axes(TargetKind::full_pose);
  ASSERT_EQ(held.size(), 1u);
  std::vector<double> commands{0.4, 0.6, -0.5, 1.1, 0.7, -0.8, 0.3};
  const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
  Machine wide = machine;
  for (Axis& axis : wide.axes) axis.endless = true;
  const InverseResult result = InverseKinematics(wide).solve(PoseTarget::at(pose), commands);
  EXPECT_EQ(result.solutions.size(), 8u);
  for (const InverseSolution& solution : result.solutions) {
    EXPECT_EQ(solution.position[held[0].axis], commands[held[0].axis]);
  }
  // Any other axis, held by name.
  for (const std::size_t axis : {0, 2, 4, 6}) {
    InverseOptions options;
    options.held = {{axis, commands[axis]}};
    const InverseResult other = InverseKinematics(machine, options).solve(PoseTarget::at(pose), commands);
    ASSERT_EQ(other.status, InverseStatus::solved) << axis;
    EXPECT_LE(nearest_to(other, commands), 1e-9) << axis;
  }
  Machine setting = machine;
  setting.axes[4].setting = true;
  EXPECT_EQ(InverseKinematics(setting).held_axes(TargetKind::full_pose).at(0).axis, 4u);
}

TEST(InverseArm, ForADirectionTheAxisAboutTheToolIsHeld) {
  const Machine machine = test::jointed_arm();
  const std::vector<HeldAxis> held = InverseKinematics(machine).held_axes(TargetKind::point_and_direction);
  ASSERT_EQ(held.size(), 1u);
  Machine on_axis = machine;
  on_axis.tool_offset = {60, 0, 0};
  EXPECT_EQ(InverseKinematics(on_axis).held_axes(TargetKind::point_and_direction).at(0).axis, machine.find_axis("A2"));
}

TEST(InverseArm, EveryTurnWithinTravelIsOffered) {
  const Machine machine = test::jointed_arm();  // A2 -400 ... 400 degrees
  const std::vector<double> commands{0.3, 0.2, -0.4, 0.5, 0.8, 20 * kDegree};
  InverseOptions options;
  options.all_turns = true;
  const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
  const InverseResult result = InverseKinematics(machine, options).solve(PoseTarget::at(pose), commands);
  int turns = 0;
  for (const InverseSolution& solution : result.solutions) {
    bool same = true;
    for (std::size_t i = 0; i < 6; ++i) same = same && apart(solution.position[i], commands[i]) < 1e-9;
    turns += same ? 1 : 0;
  }
  EXPECT_EQ(turns, 3);  // at -340, 20 and 380 degrees
  EXPECT_LE(nearest_to(result, commands), 1e-9);
}

TEST(InverseArm, AnArmOnARailKeepsTheRailWhereItStands) {
  Machine machine = test::jointed_arm();
  Axis rail{.name = "X", .kind = AxisKind::linear, .side = ChainSide::tool};
  rail.travel_max = 3000;
  machine.axes.insert(machine.axes.begin(), rail);
  const std::vector<double> commands{1250, 0.3, 0.2, -0.4, 0.5, 0.8, 0.1};
  const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
  const InverseResult result = InverseKinematics(machine).solve(PoseTarget::at(pose), commands);
  ASSERT_EQ(result.status, InverseStatus::solved);
  EXPECT_LE(nearest_to(result, commands), 1e-9);
}

}  // namespace
}  // namespace abbe
