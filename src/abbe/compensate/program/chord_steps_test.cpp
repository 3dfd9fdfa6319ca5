#include "abbe/compensate/program/chord_steps.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>
#include <set>

#include "abbe/compensate/program/errors_for_test.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

/// Commands [axes][poses] and what becomes of them.
struct CorrectedBlock {
  std::vector<std::vector<double>> commands, corrected;
  std::vector<CorrectionStatus> status;
  std::vector<double> position_left, orientation_left;

  void correct(const CompensatedInverse& inverse, std::size_t first, std::size_t count) {
    std::vector<const double*> in;
    std::vector<double*> out;
    corrected.resize(commands.size());
    for (std::size_t i = 0; i < commands.size(); ++i) {
      corrected[i].resize(commands[i].size());
      in.push_back(commands[i].data() + first);
      out.push_back(corrected[i].data() + first);
    }
    status.resize(commands[0].size());
    position_left.resize(status.size());
    orientation_left.resize(status.size());
    inverse.correct({in, count},
                    {out, status.data() + first, position_left.data() + first, orientation_left.data() + first});
  }
  std::vector<double> pose(const std::vector<std::vector<double>>& axes, std::size_t k) const {
    std::vector<double> one;
    for (const std::vector<double>& axis : axes) one.push_back(axis[k]);
    return one;
  }
};

/// Poses of a trunnion mill away from the parallel position of its rotary axes.
CorrectedBlock tilted_poses(const Machine& machine, std::size_t count) {
  std::mt19937_64 generator(5);
  CorrectedBlock block;
  block.commands.resize(machine.axes.size());
  const std::size_t a = machine.find_axis("A");
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double> pose = test::inner_commands(machine, generator);
    if (std::abs(pose[a]) < 0.15) pose[a] = pose[a] < 0 ? -0.15 : 0.15;
    for (std::size_t i = 0; i < pose.size(); ++i) block.commands[i].push_back(pose[i]);
  }
  return block;
}

/// Of the point in mm and of the tool direction in rad, by the model that knows no vectors.
std::array<double, 2> missed(const Machine& machine, const ErrorSet& errors, const std::vector<double>& wanted_at,
                             const std::vector<double>& found) {
  const RigidTransform wanted = nominal_workpiece_from_tool(machine, wanted_at);
  const RigidTransform pose = actual_workpiece_from_tool(machine, errors, found);
  const Eigen::Vector3d direction = pose.rotation * machine.tool_direction;
  const Eigen::Vector3d goal = wanted.rotation * machine.tool_direction;
  return {(pose.translation - wanted.translation).norm(),
          std::atan2(direction.cross(goal).norm(), direction.dot(goal))};
}

TEST(ChordSteps, CommandsAreThoseOfTheExactSolution) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::tens_of_micrometres(machine, 3);
  CorrectedBlock usual = tilted_poses(machine, 1000), exact = usual;
  usual.correct(CompensatedInverse(machine, errors), 0, 1000);
  CorrectionOptions options;
  options.position_tolerance = 3e-12;
  options.orientation_tolerance = 1e-14;
  exact.correct(CompensatedInverse(machine, errors, options), 0, 1000);
  for (std::size_t k = 0; k < 1000; ++k) {
    ASSERT_EQ(usual.status[k], CorrectionStatus::reached);
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      const bool rotary = machine.axes[i].kind == AxisKind::rotary;
      EXPECT_NEAR(usual.corrected[i][k], exact.corrected[i][k], rotary ? 1e-11 : 1e-9) << k << " " << i;
    }
    const auto [point, direction] =
        missed(machine, errors, usual.pose(usual.commands, k), usual.pose(usual.corrected, k));
    EXPECT_LE(point, 1.1e-9);
    EXPECT_LE(direction, 1.1e-11);
    EXPECT_NEAR(usual.position_left[k], point, 2e-11);
    EXPECT_NEAR(usual.orientation_left[k], direction, 1e-13);
  }
}

TEST(ChordSteps, TheToolMayPointAnywhere) {
  Machine machine = test::trunnion_mill();
  machine.tool_direction = Eigen::Vector3d(0.1, -0.2, 1).normalized();
  const Eigen::AngleAxisd turned(0.7, Eigen::Vector3d(0.3, 0.2, 1).normalized());
  machine.bed_from_workpiece = machine.bed_from_workpiece * RigidTransform::rotate(turned.toRotationMatrix());
  const ErrorSet errors = test::tens_of_micrometres(machine, 7);
  CorrectedBlock poses = tilted_poses(machine, 300);
  poses.correct(CompensatedInverse(machine, errors), 0, 300);
  int reached = 0;
  for (std::size_t k = 0; k < 300; ++k) {
    if (poses.status[k] != CorrectionStatus::reached) continue;
    ++reached;
    const auto [point, direction] =
        missed(machine, errors, poses.pose(poses.commands, k), poses.pose(poses.corrected, k));
    EXPECT_LE(point, 1.1e-9);
    EXPECT_LE(direction, 1.1e-11);
  }
  EXPECT_GE(reached, 270);
}

/// Angles of a degree and shifts of millimetres: the nominal derivative gains little, the actual one takes over.
TEST(ChordSteps, WhereTheyDoNotServeTheActualDerivativeDoes) {
  const Machine machine = test::trunnion_mill();
  ErrorSet errors = test::tens_of_micrometres(machine, 11);
  for (ErrorMotion& motion : errors.motions) {
    for (double& coefficient : motion.coefficients) coefficient *= 50;
  }
  CorrectionOptions options;
  options.largest_turn = 0.5;
  options.largest_shift = 200;
  CorrectedBlock poses = tilted_poses(machine, 300);
  for (std::vector<double>& axis : poses.commands) {
    for (double& command : axis) command *= 0.8;  // room for corrections of millimetres
  }
  poses.correct(CompensatedInverse(machine, errors, options), 0, 300);
  int reached = 0;
  for (std::size_t k = 0; k < 300; ++k) {
    if (poses.status[k] != CorrectionStatus::reached) continue;
    ++reached;
    const auto [point, direction] =
        missed(machine, errors, poses.pose(poses.commands, k), poses.pose(poses.corrected, k));
    EXPECT_LE(point, 1.1e-9);
    EXPECT_LE(direction, 1.1e-11);
  }
  EXPECT_GE(reached, 200);
}

/// Of every sort in one block: each pose is what it is alone, so no vector and no fallback of a neighbour changes it.
TEST(ChordSteps, APoseDoesNotDependOnTheSortOfItsNeighbours) {
  const Machine machine = test::trunnion_mill();
  const std::size_t a = machine.find_axis("A"), x = machine.find_axis("X"), y = machine.find_axis("Y");
  ErrorSet errors = test::tens_of_micrometres(machine, 13);
  const double half = machine.axes[y].travel_min + 0.9 * (machine.axes[y].travel_max - machine.axes[y].travel_min);
  const Basis part{.kind = BasisKind::legendre, .order = 1, .from = machine.axes[y].travel_min - 1, .to = half};
  errors.motions.push_back({y, Component::X, part, {0.01, 0.02}, {}});
  CorrectedBlock all = tilted_poses(machine, 203);
  for (std::size_t k = 0; k < 203; ++k) {
    if (k % 7 == 1) all.commands[a][k] = 1e-4 * static_cast<double>(k % 5);  // axes parallel
    if (k % 7 == 2) all.commands[x][k] = machine.axes[x].travel_max;         // no room
    if (k % 7 == 3) all.commands[y][k] = machine.axes[y].travel_max - 1e-3;  // errors not known
    if (k % 21 == 4) all.commands[x][k] = std::nan("");
  }
  const CompensatedInverse inverse(machine, errors);
  all.correct(inverse, 0, 203);
  CorrectedBlock alone = all;
  std::set<CorrectionStatus> sorts;
  for (std::size_t k = 0; k < 203; ++k) {
    alone.correct(inverse, k, 1);
    sorts.insert(all.status[k]);
    EXPECT_EQ(alone.status[k], all.status[k]) << k;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      if (std::isnan(all.commands[i][k])) continue;
      EXPECT_EQ(alone.corrected[i][k], all.corrected[i][k]) << k;
    }
  }
  EXPECT_TRUE(sorts.count(CorrectionStatus::reached) && sorts.count(CorrectionStatus::turn_limited) &&
              sorts.count(CorrectionStatus::outside_travel) && sorts.count(CorrectionStatus::not_covered) &&
              sorts.count(CorrectionStatus::not_finite));
}

}  // namespace
}  // namespace abbe
