#include "abbe/study/compensation/corrected_commands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "abbe/errors/actual_pose.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::HasSubstr;

CommandsRequest trunnion_commands() {
  const std::string examples = ABBE_SOURCE_DIR "/examples/";
  CommandsRequest request;
  request.machine_file = "mill.machine.toml";
  request.errors_file = "mill.errors.toml";
  request.machine = read_machine(examples + "machines/trunnion-mill.machine.toml");
  request.errors = read_errors(examples + "compensate/trunnion.errors.toml", request.machine);
  request.poses = read_poses(examples + "compensate/poses.csv", request.machine);
  return request;
}

TEST(CorrectedCommandsOfPoses, BringTheActualToolToWhereTheNominalMachineHasIt) {
  const CommandsRequest request = trunnion_commands();
  const CorrectedCommands result = correct_commands(request);
  EXPECT_EQ(result.refused, "");
  EXPECT_EQ(result.poses.count(), request.poses.count());
  std::size_t reached = 0;
  for (std::size_t row = 0; row < request.poses.count(); ++row) {
    if (!reaches_point(result.corrected.status[row])) continue;
    ++reached;
    const Eigen::Vector3d wanted = nominal_workpiece_from_tool(request.machine, request.poses.pose(row)).translation;
    const Eigen::Vector3d actual =
        actual_workpiece_from_tool(request.machine, request.errors.errors, result.corrected.commands.pose(row))
            .translation;
    EXPECT_LT((actual - wanted).norm(), 1e-9) << row;
  }
  EXPECT_GT(reached, 0U);
  EXPECT_EQ(reached + result.not_reached, request.poses.count());
  EXPECT_EQ(corrected_commands_json(result, "out.csv", false)["written"], false);
  EXPECT_THAT(corrected_commands_csv(result), HasSubstr("status"));
}

TEST(CorrectedCommandsOfPoses, AreRefusedAboveTheLimitAndSayWhatIsNotInThem) {
  CommandsRequest request = trunnion_commands();
  request.limit_um = 0.1;
  EXPECT_THAT(correct_commands(request).refused, HasSubstr("um above --limit-um 0.1: row "));
  request.limit_um.reset();
  request.errors.errors.reversals.clear();
  EXPECT_THAT(corrected_commands_text(correct_commands(request)), testing::Not(HasSubstr("reversal values")));
  request.errors.errors.reversals.push_back({.axis = 0, .value = 1e-3});
  request.errors.covariance.resize(0, 0);
  EXPECT_THAT(corrected_commands_text(correct_commands(request)), HasSubstr("reversal values are not in these"));
}

TEST(CorrectedCommandsOfPoses, WhatIsOutOfRangeIsNamedByItsOption) {
  const auto problem = [](const auto& change) {
    CommandsRequest request = trunnion_commands();
    change(request);
    return message_of([&] { correct_commands(request); });
  };
  EXPECT_THAT(problem([](CommandsRequest& r) { r.limit_um = -1; }), HasSubstr("--limit-um: -1 is not a limit"));
  EXPECT_THAT(problem([](CommandsRequest& r) { r.largest_turn = 0; }), HasSubstr("--largest-turn-deg: out of range"));
  EXPECT_THAT(problem([](CommandsRequest& r) { r.leave_out_factor = 1001; }), HasSubstr("0 to 1000 standard"));
}

}  // namespace
}  // namespace abbe
