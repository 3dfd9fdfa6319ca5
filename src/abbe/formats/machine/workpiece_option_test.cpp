#include "abbe/formats/machine/workpiece_option.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/formats/text/message_of.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Machine mill_with_part() {
  Machine mill = parse_chain("w X' b Y Z t").machine;
  mill.states.push_back({.name = "part", .unit = "degC", .reference = 20});
  mill.states.push_back({.name = "hall", .unit = "degC", .reference = 22});
  mill.states.push_back({.name = "load", .unit = "kg"});
  return mill;
}

PoseList two_poses() {
  PoseList poses;
  poses.append({0, 0, 0});
  poses.append({1, 2, 3});
  return poses;
}

std::string workpiece_refusal(const WorkpieceOptions& options,
                              const std::vector<std::string>& states = {"part_degC=25"}, PoseList poses = two_poses()) {
  return message_of([&] { workpiece_option(mill_with_part(), options, states, poses); });
}

WorkpieceOptions of_steel() {
  WorkpieceOptions options;
  options.expansion = 11.5;
  options.state = "part";
  return options;
}

TEST(WorkpieceOption, NothingIsGiven) {
  PoseList poses = two_poses();
  EXPECT_FALSE(workpiece_option(mill_with_part(), {}, {"part_degC=25"}, poses));
  EXPECT_TRUE(poses.state.empty());
}

TEST(WorkpieceOption, TakesTheTemperatureFromAnOptionOrAColumn) {
  PoseList poses = two_poses();
  WorkpieceOptions options = of_steel();
  options.u_expansion = 1;
  options.u_kelvin = 0.3;
  options.fixed_mm = {1, 2, 3};
  const auto found = workpiece_option(mill_with_part(), options, {"hall_degC=21", "part_degC=25"}, poses);
  ASSERT_TRUE(found);
  EXPECT_DOUBLE_EQ(found->coefficient, 11.5e-6);
  EXPECT_DOUBLE_EQ(found->standard_uncertainty, 1e-6);
  EXPECT_EQ(found->temperature_uncertainty, 0.3);
  EXPECT_EQ(found->fixed_point, Eigen::Vector3d(1, 2, 3));
  EXPECT_THAT(poses.state[0], ElementsAre(25, 25));
  EXPECT_THAT(workpiece_refusal(of_steel(), {"part_degC=25"}, poses), HasSubstr("is a column of the poses too"));
  poses.state[0] = {24, 26};
  EXPECT_TRUE(workpiece_option(mill_with_part(), of_steel(), {}, poses));
  EXPECT_EQ(workpiece_factor(mill_with_part(), *found, poses, 1), 6);
}

TEST(WorkpieceOption, AStatedTemperatureNeedsNoState) {
  PoseList poses = two_poses();
  WorkpieceOptions options;
  options.expansion = 23.4;
  options.temperature = 26;
  const auto of_poses = workpiece_option(mill_with_part(), options, {}, poses);
  ASSERT_TRUE(of_poses);
  EXPECT_TRUE(poses.state.empty());
  EXPECT_EQ(workpiece_factor(mill_with_part(), *of_poses, poses, 1), 6);
  EXPECT_EQ(workpiece_option(mill_with_part(), options, {})->temperature, 26.0);
  EXPECT_EQ(workpiece_option(mill_with_part(), of_steel(), {"hall_degC=21", "part_degC=25"})->temperature, 25.0);
  EXPECT_FALSE(workpiece_option(mill_with_part(), {}, {"part_degC=25"}));
  EXPECT_EQ(message_of([] { workpiece_option(mill_with_part(), of_steel(), {"hall_degC=21"}); }),
            "part_degC: the temperature of the workpiece is not given; expected --state part_degC=VALUE, or "
            "--workpiece-temperature-degC instead of --workpiece-state");
  options.state = "part";
  EXPECT_THAT(message_of([&] { workpiece_option(mill_with_part(), options, {}); }),
              HasSubstr("--workpiece-temperature-degC: is given together with --workpiece-state"));
  options.state.clear();
  options.temperature = -300;
  EXPECT_THAT(message_of([&] { workpiece_option(mill_with_part(), options, {}); }),
              HasSubstr("--workpiece-temperature-degC: out of range; expected -273.15 to 1000 degC"));
}

TEST(WorkpieceOption, WhatIsWrongIsNamed) {
  WorkpieceOptions options;
  options.state = "part";
  EXPECT_THAT(workpiece_refusal(options), HasSubstr("--workpiece-expansion-um-per-m-K: is missing"));
  options = of_steel();
  options.state.clear();
  EXPECT_THAT(workpiece_refusal(options), HasSubstr("--workpiece-state: is missing"));
  options.state = "load";
  EXPECT_THAT(workpiece_refusal(options), HasSubstr("--workpiece-state load: is not a temperature"));
  options.state = "hall";
  EXPECT_THAT(workpiece_refusal(options), HasSubstr("its reference is 22 degC, and parts are to be right at 20 degC"));
  options.state = "table";
  EXPECT_THAT(workpiece_refusal(options), HasSubstr("the machine has no such state"));
  options = of_steel();
  options.u_expansion = -1;
  EXPECT_THAT(workpiece_refusal(options), HasSubstr("--u-workpiece-expansion-um-per-m-K: out of range"));
  options = of_steel();
  options.expansion = 1e5;
  EXPECT_THAT(workpiece_refusal(options), HasSubstr("out of range; expected -1000 to 1000 um/(m K)"));
  EXPECT_THAT(workpiece_refusal(of_steel(), {}), HasSubstr("part_degC: the temperature of the workpiece is not given"));
}

}  // namespace
}  // namespace abbe
