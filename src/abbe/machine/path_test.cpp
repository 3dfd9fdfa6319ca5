#include "abbe/machine/path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "abbe/geometry/angle_units.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using std::numbers::pi;

Eigen::Vector3d tilted(double tilt, double azimuth) {
  return {std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)};
}

/// Poses whose tool goes from -30 to +30 degrees through the pole in a vertical plane.
std::vector<PoseTarget> through_the_pole(const Eigen::Vector3d& point, double azimuth) {
  std::vector<PoseTarget> path;
  for (int i = -30; i <= 30; ++i) path.push_back(PoseTarget::at(point, tilted(i * kDegree, azimuth)));
  return path;
}

/// Poses with constant tilt that turn about Z.
std::vector<PoseTarget> turning(const Eigen::Vector3d& point, double turns) {
  std::vector<PoseTarget> path;
  const int steps = static_cast<int>(std::lround(turns * 120));
  for (int i = 0; i <= steps; ++i) path.push_back(PoseTarget::at(point, tilted(0.6, i * 2 * pi / 120)));
  return path;
}

double largest_rotary_step(const Machine& machine, const PathResult& result) {
  double largest = 0;
  for (std::size_t i = 1; i < result.solutions.size(); ++i) {
    for (std::size_t k = 0; k < machine.axes.size(); ++k) {
      if (machine.axes[k].kind != AxisKind::rotary) continue;
      largest = std::max(largest, std::abs(result.solutions[i].position[k] - result.solutions[i - 1].position[k]));
    }
  }
  return largest;
}

void expect_on_path(const Machine& machine, const std::vector<PoseTarget>& path, const PathResult& result) {
  ASSERT_EQ(result.solutions.size(), path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    const auto& position = result.solutions[i].position;
    const RigidTransform pose = nominal_workpiece_from_tool(
        machine, std::vector<double>(position.begin(), position.begin() + static_cast<long>(machine.axes.size())));
    EXPECT_LE((pose.translation - path[i].point).norm(), 1e-9);
    EXPECT_LE((pose.rotation * machine.tool_direction - path[i].direction).norm(), 1e-12);
  }
}

TEST(Path, GoesThroughThePoleWithTheFreeAxisHeld) {
  for (const Machine& machine : {test::gantry_fork_head(), test::yin_engraver('U'), test::yin_engraver('P')}) {
    const Eigen::Vector3d point =
        machine.axes[0].name == "X" ? Eigen::Vector3d(2000, 1000, 700) : Eigen::Vector3d(0, 0, 300);
    const std::vector<PoseTarget> path = through_the_pole(point, 25 * kDegree);
    const PathResult result = follow_path(machine, path);
    ASSERT_EQ(result.status, PathStatus::followed) << describe(machine, result);
    expect_on_path(machine, path, result);
    EXPECT_TRUE(result.jumps.empty()) << describe(machine, result);
    EXPECT_LE(largest_rotary_step(machine, result), 1.001 * kDegree);
    EXPECT_EQ(result.solutions[30].singularity, PoseSingularity::tool_parallel);
    const std::size_t c = machine.find_axis("C") != Machine::npos ? machine.find_axis("C") : machine.find_axis("C1");
    EXPECT_NEAR(result.solutions[30].position[c], result.solutions[29].position[c], 1e-12);
    // Switching the branch at the pole instead would turn C by 180 degrees.
    EXPECT_NEAR(result.solutions[60].position[c], result.solutions[0].position[c], 1e-9);
  }
}

TEST(Path, SaysWhereTheBranchMustSwitchBecauseTravelEnds) {
  // A of the trunnion goes from -120 to +30 only: the tilt to +60 degrees needs the table turned by half a turn.
  const Machine machine = test::trunnion_mill();
  std::vector<PoseTarget> path;
  for (int i = -60; i <= 60; ++i) path.push_back(PoseTarget::at({10, 20, 0}, tilted(i * kDegree, pi / 2)));
  const PathResult result = follow_path(machine, path);
  ASSERT_EQ(result.status, PathStatus::followed) << describe(machine, result);
  expect_on_path(machine, path, result);
  ASSERT_EQ(result.jumps.size(), 1u) << describe(machine, result);
  EXPECT_NEAR(std::abs(result.jumps[0].turn), pi, 1e-9);
  EXPECT_EQ(machine.axes[result.jumps[0].axis].name, "C");
  // The cheapest place for it is the pole, where only C turns.
  EXPECT_TRUE(result.jumps[0].leaves_singular_pose);
  EXPECT_NEAR(static_cast<double>(result.jumps[0].pose), 60.5, 0.5);
  EXPECT_NE(describe(machine, result).find("C turns"), std::string::npos);
  EXPECT_NE(describe(machine, result).find("in a singular pose"), std::string::npos);
}

TEST(Path, LooksAheadSoThatAnAxisStartsOnTheTurnThatLetsItThrough) {
  const Machine machine = test::gantry_fork_head();  // C -360 ... 360
  const std::vector<PoseTarget> path = turning({2000, 1000, 700}, 1.75);
  const PathResult result = follow_path(machine, path);
  ASSERT_EQ(result.status, PathStatus::followed);
  expect_on_path(machine, path, result);
  EXPECT_TRUE(result.jumps.empty()) << describe(machine, result);
  EXPECT_NEAR(result.solutions.back().position[3] - result.solutions.front().position[3], 1.75 * 2 * pi, 1e-9);
}

TEST(Path, UnwindsOnceWhereTheTravelIsUsedUp) {
  const Machine machine = test::gantry_fork_head();
  const std::vector<PoseTarget> path = turning({2000, 1000, 700}, 3);
  const PathResult result = follow_path(machine, path);
  ASSERT_EQ(result.status, PathStatus::followed);
  expect_on_path(machine, path, result);
  EXPECT_EQ(result.jumps.size(), 1u) << describe(machine, result);
  EXPECT_GT(std::abs(result.jumps[0].turn), 170 * kDegree);
}

TEST(Path, FollowsEndlessAxesOverManyTurns) {
  const Machine machine = test::trunnion_mill();
  const std::vector<PoseTarget> path = turning({10, 20, 0}, 5);
  PathOptions options;
  options.start = {100 * 2 * pi, -0.5, 0, 0, 0};
  const PathResult result = follow_path(machine, path, options);
  ASSERT_EQ(result.status, PathStatus::followed) << describe(machine, result);
  EXPECT_TRUE(result.jumps.empty());
  EXPECT_LE(largest_rotary_step(machine, result), 3.001 * kDegree);
  EXPECT_NEAR(std::abs(result.solutions.back().position[0] - result.solutions.front().position[0]), 10 * pi, 1e-9);
  EXPECT_NEAR(result.solutions.front().position[0], 100 * 2 * pi, pi);
}

TEST(Path, BeginsOnTheBranchNearestToTheAxesThatTheStartNames) {
  const Machine machine = test::gantry_fork_head();  // X, Y, Z, C, A
  std::vector<PoseTarget> path;
  for (int i = 0; i < 10; ++i) path.push_back(PoseTarget::at({2000, 1000, 700}, tilted(0.4, 0.02 * i)));
  const std::size_t c = machine.find_axis("C"), a = machine.find_axis("A");
  const auto solutions = InverseKinematics(machine).solve(path[0]).solutions;
  ASSERT_GE(solutions.size(), 2u);
  for (const InverseSolution& branch : solutions) {
    if (!branch.within_travel) continue;
    for (const std::size_t named : {a, c}) {
      PathOptions options;
      options.start.assign(machine.axes.size(), std::nan(""));
      options.start[named] = branch.position[named] + 0.05;
      const PathResult result = follow_path(machine, path, options);
      ASSERT_EQ(result.status, PathStatus::followed) << describe(machine, result);
      EXPECT_NEAR(result.solutions[0].position[a], branch.position[a], 1e-9) << machine.axes[named].name;
      EXPECT_NEAR(std::remainder(result.solutions[0].position[c] - branch.position[c], 2 * pi), 0, 1e-9);
    }
  }
}

TEST(Path, AStartThatDoesNotDecideSaysWhichAxesWould) {
  const Machine machine = test::gantry_fork_head();
  const std::vector<PoseTarget> path = {PoseTarget::at({2000, 1000, 700}, tilted(0.4, 0))};
  PathOptions options;
  options.start.assign(machine.axes.size(), std::nan(""));
  // Half way between the two tilts of the head.
  options.start[machine.find_axis("A")] = 0;
  const PathResult result = follow_path(machine, path, options);
  EXPECT_EQ(result.status, PathStatus::start_undecided);
  EXPECT_TRUE(result.solutions.empty());
  EXPECT_NE(describe(machine, result).find("it needs a command of "), std::string::npos);
  EXPECT_NE(describe(machine, result).find("C"), std::string::npos) << describe(machine, result);
  // Where a branch needs a jump later the other one is meant.
  PathOptions none;
  EXPECT_EQ(follow_path(machine, path, none).status, PathStatus::followed);
}

TEST(Path, IsTheShortestOfAllSequencesOfBranches) {
  // Against exhaustive search on a short path with both branches everywhere.
  const Machine machine = test::gantry_fork_head();
  std::vector<PoseTarget> path;
  for (int i = 0; i < 6; ++i) path.push_back(PoseTarget::at({2000, 1000, 700}, tilted(0.3, 1.1 * i)));
  PathOptions options;
  options.largest_turn = 100;  // no step counts as a jump: length alone decides
  const PathResult result = follow_path(machine, path, options);
  ASSERT_EQ(result.status, PathStatus::followed);
  InverseOptions inverse_options;
  inverse_options.all_turns = true;
  const InverseKinematics inverse(machine, inverse_options);
  std::vector<std::vector<InverseSolution>> nodes;
  for (const PoseTarget& target : path) nodes.push_back(inverse.solve(target).solutions);
  double best = 1e300;
  const auto visit = [&](const auto& self, std::size_t pose, const InverseSolution* before, double length) -> void {
    if (pose == nodes.size()) {
      best = std::min(best, length);
      return;
    }
    for (const InverseSolution& node : nodes[pose]) {
      double sum = 0;
      for (std::size_t k = 0; before != nullptr && k < 5; ++k) {
        const double move = node.position[k] - before->position[k];
        sum += (k < 3 ? 1.0 : 1e4) * move * move;
      }
      self(self, pose + 1, &node, length + std::sqrt(sum));
    }
  };
  visit(visit, 0, nullptr, 0);
  EXPECT_NEAR(result.length, best, 1e-9 * best);
}

TEST(Path, StopsAtThePoseThatCannotBeReached) {
  const Machine machine = test::trunnion_mill();
  std::vector<PoseTarget> path = turning({0, 0, 0}, 0.1);
  path[5].point.x() = 5000;
  PathResult result = follow_path(machine, path);
  EXPECT_EQ(result.status, PathStatus::outside_travel);
  EXPECT_EQ(result.failed_pose, 5u);
  EXPECT_TRUE(result.solutions.empty());
  EXPECT_EQ(describe(machine, result).substr(0, 23), "pose 5: outside travel:");
  path[3].direction.setZero();
  result = follow_path(machine, path);
  EXPECT_EQ(result.status, PathStatus::not_reached);
  EXPECT_EQ(result.failed_pose, 3u);
  EXPECT_EQ(PathResult{}.status, PathStatus::not_run);
}

}  // namespace
}  // namespace abbe
