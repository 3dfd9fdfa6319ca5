#include "abbe/formats/machine/obstacle_option.h"

#include <gmock/gmock.h>

#include <limits>

#include "abbe/formats/text/message_of.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

using testing::HasSubstr;

Obstacle box_on_mill(const std::string& text) {
  return box_obstacle_option(parse_chain("w C' b X Z t").machine, "--obstacle-box-mm", text, 2);
}

TEST(AnObstacleOption, NamesWhatCarriesABoxAndItsCorners) {
  const Obstacle box = box_on_mill("table=-1,2,3,4,-5,6.5");
  EXPECT_EQ(box.name, "box 2");
  EXPECT_EQ(box.carrier, ObstacleCarrier::table);
  EXPECT_EQ(box.mesh.vertices.rowwise().minCoeff(), Eigen::Vector3d(-1, -5, 3));
  EXPECT_EQ(box.mesh.vertices.rowwise().maxCoeff(), Eigen::Vector3d(4, 2, 6.5));
  EXPECT_EQ(box_on_mill("base=0,0,0,1,1,1").carrier, ObstacleCarrier::base);
  const Obstacle on_axis = box_on_mill("Z=0,0,0,1,1,1");
  EXPECT_EQ(on_axis.carrier, ObstacleCarrier::axis);
  EXPECT_EQ(on_axis.axis, 2U);
}

TEST(AnObstacleOption, IsRefusedWithTheFormThatWasExpected) {
  const auto message = [](const std::string& text) {
    return message_of([&] { static_cast<void>(box_on_mill(text)); });
  };
  EXPECT_THAT(message("W=0,0,0,1,1,1"), HasSubstr("where ON is base, table or an axis of w C' b X Z t"));
  EXPECT_THAT(message("0,0,0,1,1,1"), HasSubstr("not understood"));
  EXPECT_THAT(message("base="), HasSubstr("--obstacle-box-mm base=: not understood"));
  EXPECT_THAT(message("base=0,0,0,1,1"), HasSubstr("not six numbers"));
  EXPECT_THAT(message("base=0,0,0,1,1,1,1"), HasSubstr("not six numbers"));
  EXPECT_THAT(message("base=0,0,0,1,1,0"), HasSubstr("without volume"));
  EXPECT_THAT(message("base=0,0,0,1,1,1e200"), HasSubstr("too large"));
}

TEST(ABoxAsAnObstacle, IsRefusedWithTheNameOfItsField) {
  const Machine machine = parse_chain("w C' b X Z t").machine;
  const auto message = [&](const std::array<double, 6>& corners) {
    return message_of([&] { static_cast<void>(box_obstacle({}, corners, 1, "boxes", "(x0, y0, z0, x1, y1, z1)")); });
  };
  EXPECT_THAT(message({0, 0, 0, 1, 1, 0}),
              HasSubstr("boxes: a box without volume; expected two opposite corners, (x0"));
  EXPECT_THAT(message({0, 0, 0, 1, 1, std::numeric_limits<double>::quiet_NaN()}), HasSubstr("boxes: too large"));
  EXPECT_THAT(message({-std::numeric_limits<double>::infinity(), 0, 0, 1, 1, 1}), HasSubstr("boxes: too large"));
  EXPECT_FALSE(obstacle_on(machine, "Q").has_value());
  EXPECT_EQ(obstacle_on(machine, "X")->axis, 1U);
}

}  // namespace
}  // namespace abbe
