#include "abbe/report/pages/path_data.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

namespace abbe {
namespace {

Machine two_axes() {
  Machine machine;
  Axis x, c;
  x.name = "X";
  x.travel_min = -10;
  x.travel_max = 500;
  c.name = "C";
  c.kind = AxisKind::rotary;
  c.endless = true;
  machine.axes = {c, x};
  return machine;
}

PathPicture path_of(std::size_t n, std::size_t pause) {
  PathPicture path;
  for (std::size_t i = 0; i < n; ++i) {
    const double at = static_cast<double>(i);
    DrawnMove move;
    move.command[0] = 0.1 * at;
    move.command[1] = at;
    move.point = Eigen::Vector3d(at, -at, 1 / 3.0);
    move.direction = Eigen::Vector3d::UnitZ();
    move.working = i % pause != 0;
    move.time = 2 * at;
    path.moves.push_back(move);
  }
  return path;
}

TEST(PathData, HoldsEveryMoveOfAShortPathInUnitsOfTheirNames) {
  const nlohmann::json json = path_data(two_axes(), path_of(5, 3));
  EXPECT_EQ(json.at("moves"), 5);
  EXPECT_EQ(json.at("time_s"), nlohmann::json({0.0, 2.0, 4.0, 6.0, 8.0}));
  EXPECT_EQ(json.at("working"), nlohmann::json({0, 1, 1, 0, 1}));
  EXPECT_EQ(json.at("axes"), nlohmann::json({"C_deg", "X_mm"}));
  EXPECT_NEAR(json.at("commands").at("C_deg").at(2).get<double>(), 0.2 * 180 / std::numbers::pi, 1e-5);
  EXPECT_EQ(json.at("commands").at("X_mm").at(4), 4.0);
  EXPECT_EQ(json.at("travel").at("X_mm"), nlohmann::json({-10.0, 500.0}));
  EXPECT_FALSE(json.at("travel").contains("C_deg"));
  EXPECT_EQ(json.at("point_mm").at("z").at(0), 0.3333333);
  EXPECT_FALSE(json.contains("feed_mm_per_min"));
}

TEST(PathData, ALongPathKeepsItsEndsAndWhereWorkBeginsAndEnds) {
  const PathPicture path = path_of(100000, 1000);
  const nlohmann::json json = path_data(two_axes(), path, 2000);
  const std::size_t drawn = json.at("time_s").size();
  EXPECT_LE(drawn, 2000U);
  EXPECT_GT(drawn, 1500U);
  EXPECT_EQ(json.at("moves"), 100000);
  EXPECT_EQ(json.at("time_s").at(0), 0.0);
  EXPECT_EQ(json.at("time_s").at(drawn - 1), 199998.0);
  std::size_t rapid = 0;
  for (const auto& working : json.at("working")) rapid += working == 0 ? 1 : 0;
  EXPECT_EQ(rapid, 100U);
  // More beginnings than there is room for.
  EXPECT_LE(path_data(two_axes(), path_of(100000, 2), 2000).at("time_s").size(), 2001U);
  EXPECT_EQ(path_data(two_axes(), {}).at("moves"), 0);
}

}  // namespace
}  // namespace abbe
