#include "abbe/errors/error_set.h"

#include <gtest/gtest.h>

namespace abbe {
namespace {

Machine three_axes() {
  Machine machine;
  Axis x{.name = "X"}, c{.name = "C2", .kind = AxisKind::rotary};
  c.direction = Eigen::Vector3d::UnitZ();
  Axis head{.name = "B", .kind = AxisKind::rotary};
  head.direction = Eigen::Vector3d(0, 1, 1).normalized();
  machine.axes = {x, c, head};
  return machine;
}

TEST(ErrorSet, NamesFollowIso230) {
  const Machine machine = three_axes();
  EXPECT_EQ(error_motion_name(machine, 0, Component::Y), "EYX");
  EXPECT_EQ(error_motion_name(machine, 1, Component::A), "EAC2");
  EXPECT_EQ(location_error_name(machine, 1, Component::B), "EB0C2");
}

TEST(ErrorSet, NamesAreParsedBack) {
  const Machine machine = three_axes();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < kComponentCount; ++k) {
      const Component component = static_cast<Component>(k);
      std::size_t parsed_axis;
      Component parsed;
      bool location;
      ASSERT_TRUE(
          parse_error_name(machine, error_motion_name(machine, axis, component), parsed_axis, parsed, location));
      EXPECT_TRUE(parsed_axis == axis && parsed == component && !location);
      ASSERT_TRUE(
          parse_error_name(machine, location_error_name(machine, axis, component), parsed_axis, parsed, location));
      EXPECT_TRUE(parsed_axis == axis && parsed == component && location);
    }
  }
  std::size_t axis;
  Component component;
  bool location;
  for (const char* text : {"", "E", "EX", "EQX", "EXY", "EX0", "EX0Y", "exx", "EXC"}) {
    EXPECT_FALSE(parse_error_name(machine, text, axis, component, location)) << text;
  }
}

TEST(ErrorSet, ParametersRoundTripInTheOrderOfTheirNames) {
  const Machine machine = three_axes();
  ErrorSet errors;
  errors.motions.push_back(
      {0, Component::X, {.kind = BasisKind::legendre, .order = 1, .from = 0, .to = 1}, {1, 2}, {}});
  errors.motions.push_back(
      {1, Component::C, {.kind = BasisKind::fourier, .order = 1, .to = 6, .period = 6}, {3, 4, 5}, {}});
  errors.locations.push_back({0, Component::C, 6, 0});
  errors.tool_offset_error = {7, 8, 9};
  EXPECT_EQ(errors.parameters(), (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(parameter_names(machine, errors),
            (std::vector<std::string>{"EXX[P0]", "EXX[P1]", "ECC2[mean]", "ECC2[cos1]", "ECC2[sin1]", "EC0X", "tool_X",
                                      "tool_Y", "tool_Z"}));
  EXPECT_EQ(parameters_are_angles(machine, errors), (std::vector<bool>{0, 0, 1, 1, 1, 1, 0, 0, 0}));
  errors.set_parameters({9, 8, 7, 6, 5, 4, 3, 2, 1});
  EXPECT_EQ(errors.parameters(), (std::vector<double>{9, 8, 7, 6, 5, 4, 3, 2, 1}));
}

TEST(ErrorSet, TermsOfOneErrorMotionAddUp) {
  ErrorSet errors;
  const Basis line{.kind = BasisKind::monomial, .order = 1, .from = -1, .to = 1};
  errors.motions.push_back({0, Component::Y, line, {1, 2}, {}});
  errors.motions.push_back({0, Component::Y, line, {10, 20}, {}});
  EXPECT_DOUBLE_EQ(errors.evaluate(0, 0.5)[1], 22);
  EXPECT_FALSE(errors.covers(0, 2));
  EXPECT_TRUE(errors.covers(1, 2));
}

TEST(LocationError, WithoutEffectIsNotValid) {
  const Machine machine = three_axes();
  EXPECT_TRUE(location_error_is_valid(machine.axes[0], Component::C));
  EXPECT_TRUE(location_error_is_valid(machine.axes[0], Component::X));
  EXPECT_FALSE(location_error_is_valid(machine.axes[0], Component::A));
  EXPECT_FALSE(location_error_is_valid(machine.axes[0], Component::Y));
  EXPECT_TRUE(location_error_is_valid(machine.axes[1], Component::X));
  EXPECT_FALSE(location_error_is_valid(machine.axes[1], Component::Z));
  EXPECT_TRUE(is_zero_position_error(machine.axes[1], Component::C));
  EXPECT_TRUE(location_error_is_valid(machine.axes[2], Component::Z));
}

}  // namespace
}  // namespace abbe
