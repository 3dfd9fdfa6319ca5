#include "abbe/plan/ways/clear_ways.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/surface/mesh_check.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

/// Tool along -Z over a table C in a cradle A on Y; the functional point is the machine's origin with all axes at zero.
Machine cradle_mill() {
  Machine machine = parse_chain("w C' A' Y' b X Z t").machine;
  machine.axes[1].point = {0, 3, 50};
  machine.axes[3].travel_min = -300;
  machine.axes[3].travel_max = 300;
  return machine;
}

Obstacle table_box(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return {"box 1", box_mesh(from, to), ObstacleCarrier::table, 0};
}

double segment_distance_sampled(const Machine& machine, const ClosestPointFinder& finder,
                                const std::vector<double>& pose, const ToolShape& tool) {
  const RigidTransform seen = nominal_workpiece_from_tool(machine, pose);
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= 30; ++k) {
    const Eigen::Vector3d point =
        seen.translation + k / 30.0 * tool.length * (seen.rotation * machine.tool_direction).eval();
    least = std::min(least, finder.closest_to(point).distance);
  }
  return least;
}

TEST(ABoxMesh, EnclosesItsVolumeWhateverTheOrderOfItsCorners) {
  const MeshCheck check = check_mesh(box_mesh({3, -1, 2}, {1, 4, 7}));
  EXPECT_TRUE(check.encloses_volume());
  EXPECT_NEAR(check.volume, 2 * 5 * 5, 1e-12);
}

TEST(ABallMesh, EnclosesTheBallByTwoPercentAtMost) {
  const Eigen::Vector3d centre(3, -4, 5);
  const TriangleMesh mesh = ball_mesh(centre, 12.5);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_TRUE(check.encloses_volume());
  EXPECT_GT(check.volume, 0);
  EXPECT_LE((mesh.vertices.colwise() - centre).colwise().norm().maxCoeff(), 1.02 * 12.5);
  const ClosestPointFinder finder(mesh);
  EXPECT_LE(finder.closest_to(centre).distance, -12.5 + 1e-9);
}

TEST(ClearWays, AreStraightWithoutObstaclesAndPastThem) {
  const Machine machine = cradle_mill();
  const std::vector<double> from = {0, 0, 0, -150, 30}, to = {0, 0, 0, 150, 30};
  const ClearWays free(machine, {}, {5, 100});
  EXPECT_TRUE(free.find(from, to).is_clear);
  // 6 mm beside a box; the tool has 5 mm.
  const ClearWays past(machine, {table_box({-50, 6, 0}, {50, 80, 60})}, {5, 100});
  const Way way = past.find(from, to);
  EXPECT_TRUE(way.is_clear);
  EXPECT_TRUE(way.via.empty());
  const ClearWays touching(machine, {table_box({-50, 4.9, 0}, {50, 80, 60})}, {5, 100});
  const auto collision = touching.straight(from, to);
  ASSERT_TRUE(collision);
  EXPECT_EQ(collision->obstacle, 0U);
  EXPECT_NEAR(collision->distance, 4.9, 1e-9);
  EXPECT_LT(std::abs(collision->pose[3]), 55);
}

TEST(ClearWays, SeeTheHolderAboveThePoint) {
  const Machine machine = cradle_mill();
  // The point passes below a beam of the bed that the holder meets.
  const Obstacle beam{"beam", box_mesh({-10, -100, 90}, {10, 100, 110}), ObstacleCarrier::base, 0};
  const std::vector<double> from = {0, 0, 0, -150, 0}, to = {0, 0, 0, 150, 0};
  EXPECT_FALSE(ClearWays(machine, {beam}, {5, 80}).straight(from, to));
  EXPECT_TRUE(ClearWays(machine, {beam}, {5, 86}).straight(from, to));
}

TEST(ClearWays, CountThePlaceWithinAClosedBodyAsTouching) {
  const Machine machine = cradle_mill();
  const std::vector<double> inside = {0, 0, 0, 0, 50};
  const ClearWays ways(machine, {table_box({-100, -100, 0}, {100, 100, 100})}, {1, 0});
  const auto collision = ways.standing(inside);
  ASSERT_TRUE(collision);
  EXPECT_NEAR(collision->distance, -50, 1e-9);
}

TEST(ClearWays, FollowWhatCarriesTheObstacle) {
  const Machine machine = cradle_mill();
  // A post on the table beside the tool; C turns it into the tool, and only what it carries.
  const Eigen::Vector3d low(40, -5, -20), high(60, 5, 40);
  const std::vector<double> from = {0, 0, 0, 0, 0}, to = {180 * kDegree, 0, 0, 0, 0};
  std::vector<double> beside_from = from, beside_to = to;
  beside_from[3] = beside_to[3] = -50;
  EXPECT_FALSE(ClearWays(machine, {table_box(low, high)}, {5, 50}).straight(from, to));
  EXPECT_TRUE(ClearWays(machine, {table_box(low, high)}, {5, 50}).straight(beside_from, beside_to));
  for (std::size_t carrier = 0; carrier < machine.axes.size(); ++carrier) {
    const Obstacle post{"post", box_mesh(low, high), ObstacleCarrier::axis, carrier};
    EXPECT_EQ(ClearWays(machine, {post}, {5, 50}).straight(beside_from, beside_to).has_value(), carrier == 0)
        << carrier;
  }
  // What X carries goes along with the tool; what Z carries never comes nearer.
  std::vector<double> at_x = from;
  at_x[3] = 55;
  EXPECT_TRUE(
      ClearWays(machine, {{"post", box_mesh(low, high), ObstacleCarrier::base, 0}}, {5, 50}).straight(from, at_x));
  EXPECT_FALSE(
      ClearWays(machine, {{"post", box_mesh(low, high), ObstacleCarrier::axis, 3}}, {5, 50}).straight(from, at_x));
}

TEST(ClearWays, AcceptNoWayThatADenseSamplingFindsTouching) {
  const Machine machine = cradle_mill();
  const Obstacle box = table_box({-60, -40, -30}, {20, 70, 40});
  const ClosestPointFinder finder(box.mesh);
  const ToolShape tool{8, 90};
  const ClearWays ways(machine, {box}, tool);
  int clear = 0, touching = 0, near = 0;
  for (std::uint64_t seed = 0; seed < 80; ++seed) {
    RandomStream random(91, seed);
    std::vector<double> from, to;
    for (std::vector<double>* pose : {&from, &to}) {
      for (const double range : {180 * kDegree, 60 * kDegree, 120.0, 120.0, 100.0}) {
        pose->push_back(range * (2 * random.uniform() - 1));
      }
      pose->back() += 60;
    }
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= 300; ++k) {
      std::vector<double> pose(from.size());
      for (std::size_t i = 0; i < pose.size(); ++i) pose[i] = from[i] + k / 300.0 * (to[i] - from[i]);
      least = std::min(least, segment_distance_sampled(machine, finder, pose, tool));
    }
    const auto collision = ways.straight(from, to);
    if (!collision) {
      EXPECT_GT(least, tool.radius) << seed;
      ++clear;
    } else {
      // Between two samples the tool moves by less than that.
      EXPECT_LT(least, tool.radius + 5) << seed;
      EXPECT_LE(collision->distance, tool.radius + ClearWays::kTouching) << seed;
      ++touching;
    }
    near += std::abs(least - tool.radius) < 15 ? 1 : 0;
  }
  EXPECT_GT(clear, 20);
  EXPECT_GT(touching, 20);
  EXPECT_GT(near, 10);
}

TEST(ClearWays, RetractAlongTheToolWithoutTurningAsFarAsTravelAllows) {
  const Machine machine = cradle_mill();
  const ClearWays ways(machine, {}, {}, {80, {}});
  const std::vector<double> pose = {25 * kDegree, -35 * kDegree, 20, -30, 10};
  const auto away = ways.retracted(pose);
  ASSERT_TRUE(away);
  const RigidTransform before = nominal_workpiece_from_tool(machine, pose);
  const RigidTransform after = nominal_workpiece_from_tool(machine, *away);
  EXPECT_LT((after.rotation - before.rotation).norm(), 1e-12);
  EXPECT_LT((after.translation - before.translation - 80 * (before.rotation * machine.tool_direction)).norm(), 1e-9);
  std::vector<double> high = pose;
  high[4] = 220;
  ASSERT_TRUE(ways.retracted(high));
  EXPECT_NEAR((*ways.retracted(high))[4], 250, 1e-9);
  high[4] = 250;
  EXPECT_FALSE(ways.retracted(high));
  EXPECT_FALSE(ClearWays(machine, {}, {}).retracted(pose));
}

TEST(ClearWays, RetractAToolThatTurnsWithAHead) {
  const Machine machine = parse_chain("w b X Y Z B t").machine;
  const std::vector<double> pose = {10, 20, 30, 40 * kDegree};
  const auto away = ClearWays(machine, {}, {}, {60, {}}).retracted(pose);
  ASSERT_TRUE(away);
  const RigidTransform before = nominal_workpiece_from_tool(machine, pose);
  const RigidTransform after = nominal_workpiece_from_tool(machine, *away);
  EXPECT_LT((after.translation - before.translation - 60 * (before.rotation * machine.tool_direction)).norm(), 1e-9);
  // Without an axis along the tool there is no way back.
  EXPECT_FALSE(ClearWays(parse_chain("w b X Y t").machine, {}, {}, {60, {}}).retracted({0, 0}));
}

TEST(ClearWays, GoAroundAndEveryLineOfTheirsIsClear) {
  const Machine machine = cradle_mill();
  const std::vector<Obstacle> obstacles = {table_box({-60, -60, 0}, {60, 60, 80})};
  const std::vector<double> from = {0, 0, 0, -150, 30}, to = {90 * kDegree, -20 * kDegree, 0, 170, 60};
  EXPECT_FALSE(ClearWays(machine, obstacles, {5, 100}).find(from, to).is_clear);
  EXPECT_FALSE(ClearWays(machine, obstacles, {5, 100}, {20, {}}).find(from, to).is_clear);
  for (const WayOptions& options : {WayOptions{150, {}}, WayOptions{0, {{4, 240}}}, WayOptions{20, {{4, 240}}}}) {
    const ClearWays ways(machine, obstacles, {5, 100}, options);
    const Way way = ways.find(from, to);
    ASSERT_TRUE(way.is_clear);
    ASSERT_FALSE(way.via.empty());
    EXPECT_TRUE(way.collision);
    std::vector<double> at = from;
    std::vector<std::vector<double>> poses = way.via;
    poses.push_back(to);
    for (const std::vector<double>& pose : poses) {
      EXPECT_FALSE(ways.straight(at, pose));
      for (std::size_t i = 0; i < pose.size(); ++i) {
        EXPECT_LE(pose[i], machine.axes[i].travel_max);
        EXPECT_GE(pose[i], machine.axes[i].travel_min);
      }
      at = pose;
    }
  }
}

TEST(ClearWays, KnowOnlyTheSurfaceOfAnOpenMesh) {
  const Machine machine = cradle_mill();
  TriangleMesh open = box_mesh({-100, -100, 0}, {100, 100, 100});
  open.triangles.conservativeResize(3, 11);
  const ClearWays ways(machine, {{"open", open, ObstacleCarrier::table, 0}}, {1, 0});
  EXPECT_FALSE(ways.standing({0, 0, 0, 0, 50}));
  EXPECT_TRUE(ways.standing({0, 0, 0, 99.5, 50}));
  EXPECT_TRUE(ways.straight({0, 0, 0, 0, 50}, {0, 0, 0, -150, 50}));
}

}  // namespace
}  // namespace abbe
