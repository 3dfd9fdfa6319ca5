// `abbe compensate poses` of robot programs, and `abbe import --dh`.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "abbe/errors/actual_pose.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/robot/robot_program.h"
#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

class CompensateRobot : public CommandTest {
 protected:
  const std::string examples = (std::filesystem::path(ABBE_SOURCE_DIR) / "examples/robot/").string();

  CommandResult program(const std::string& file, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"compensate",
                                          "poses",
                                          file,
                                          "--machine",
                                          examples + "arm.machine.toml",
                                          "--errors",
                                          examples + "arm.errors.toml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return abbe(arguments);
  }
};

TEST_F(CompensateRobot, ProgramsOfEveryLanguageAreWrittenAgain) {
  const Machine machine = read_machine(examples + "arm.machine.toml");
  const ErrorSet errors = read_errors(examples + "arm.errors.toml", machine).errors;
  for (const std::string name : {"arm.mod", "arm.dat", "arm.src", "arm.ls", "arm.script"}) {
    const CommandResult result = program(examples + name, {"-o", name, "--json"});
    ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json.at("written"), true);
    const std::string before = read_text_file(examples + name), after = folder.read(name);
    EXPECT_NE(after, before);
    const RobotProgram was = parse_robot_program(before, *robot_language_of(name), name);
    const RobotProgram is = parse_robot_program(after, *robot_language_of(name), name);
    ASSERT_EQ(is.positions.size(), was.positions.size());
    // The first position of each is in joints: checked by the model of the errors alone.
    std::vector<double> wanted, commands;
    for (std::size_t i = 0; i < 6; ++i) {
      wanted.push_back(was.positions[0].joints[i]->value * robot_joint_unit(was.language, false));
      commands.push_back(is.positions[0].joints[i]->value * robot_joint_unit(is.language, false));
    }
    const double left = (actual_workpiece_from_tool(machine, errors, commands).translation -
                         nominal_workpiece_from_tool(machine, wanted).translation)
                            .norm();
    EXPECT_LE(left, name == "arm.ls" ? 0.02 : 1e-4) << name;
    EXPECT_NEAR(1e3 * left, json.at("positions")[0].at("position_left_um").get<double>(), 1e-3);
  }
}

TEST_F(CompensateRobot, WhatMustNotBeUsedIsNotWritten) {
  const CommandResult limited = program(examples + "arm.mod", {"-o", "out.mod", "--limit-um", "1"});
  EXPECT_EQ(limited.exit_code, ExitCode::computation_says_no);
  EXPECT_THAT(limited.err, HasSubstr("above --limit-um 1; nothing written"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out.mod"));
  folder.write("bad.script", "def a():\n  movej([0, 0.1, 0.2, 0, 0.5])\nend\n");
  const CommandResult bad = program("bad.script", {"-o", "out.script"});
  EXPECT_EQ(bad.exit_code, ExitCode::bad_input);
  EXPECT_THAT(bad.err, HasSubstr("bad.script:2:"));
  const CommandResult dry = program(examples + "arm.ls", {"--dry-run"});
  EXPECT_EQ(dry.exit_code, ExitCode::done) << dry.err;
  EXPECT_THAT(dry.out, HasSubstr("dry run: nothing written"));
  folder.write("own.src", read_text_file(examples + "arm.src"));
  EXPECT_EQ(program("own.src", {"-o", "./own.src", "--force"}).exit_code, ExitCode::bad_input);
}

TEST_F(CompensateRobot, PosesOfAnArmUnderLoadAreReachedWhole) {
  const std::vector<std::string> arm = {"--machine", examples + "loaded.machine.toml", "--errors",
                                        examples + "loaded.errors.toml"};
  const auto poses = [&](const std::string& file, std::vector<std::string> more) {
    more.insert(more.begin(), {"compensate", "poses", file});
    more.insert(more.end(), arm.begin(), arm.end());
    return abbe(more);
  };
  const CommandResult result = poses(examples + "loaded.poses.csv", {"-o", "corrected.csv"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
  const Machine machine = read_machine(examples + "loaded.machine.toml");
  const ErrorSet errors = read_errors(examples + "loaded.errors.toml", machine, StatesOfErrors::allowed).errors;
  const PoseList before = read_poses(examples + "loaded.poses.csv", machine);
  MeasurementOptions of_result;
  of_result.mapping.ignore = {"status", "correction_um", "u_correction_um", "position_left_um",
                              "orientation_left_urad"};
  const PoseList after = read_poses((folder.path() / "corrected.csv").string(), machine, of_result);
  ASSERT_EQ(after.count(), before.count());
  const std::size_t payload = find_state(machine, "payload");
  for (std::size_t k = 0; k < before.count(); ++k) {
    std::vector<double> given(machine.states.size(), std::nan(""));
    given[payload] = before.state[payload][k];
    const RigidTransform wanted = nominal_workpiece_from_tool(machine, before.pose(k));
    const RigidTransform off = actual_workpiece_from_tool(machine, errors, before.pose(k), given);
    const RigidTransform actual = actual_workpiece_from_tool(machine, errors, after.pose(k), given);
    EXPECT_GE((off.translation - wanted.translation).norm(), 0.05);
    EXPECT_LE((actual.translation - wanted.translation).norm(), 1e-6);
    EXPECT_LE((actual.rotation - wanted.rotation).norm(), 1e-8);
  }
  // The first two poses differ by their load alone: the springs take 5 kg more.
  EXPECT_GT(std::abs(after.axis[1][1] - after.axis[1][0]), 1e-5);
  folder.write("unloaded.csv", "A1_deg,A2_deg,A3_deg,A4_deg,A5_deg,A6_deg\n0,-20,30,0,45,0\n");
  const CommandResult unknown = poses("unloaded.csv", {"--dry-run"});
  EXPECT_EQ(unknown.exit_code, ExitCode::bad_input);
  EXPECT_THAT(unknown.err, HasSubstr("payload_kg: the errors depend on this state, and the poses do not give it"));
  const CommandResult program = poses(examples + "arm.mod", {"--dry-run"});
  EXPECT_EQ(program.exit_code, ExitCode::bad_input);
  EXPECT_THAT(program.err, HasSubstr("state.payload: the errors depend on this measured state"));
}

TEST_F(CompensateRobot, TablesOfJointsBecomeMachineFiles) {
  for (const std::string name : {"arm.dh.toml", "arm.dh.csv"}) {
    const CommandResult result = abbe({"import", "--dh", examples + name, "-o", "arm.machine.toml", "--force"});
    ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
    EXPECT_EQ(read_machine(folder.path() / "arm.machine.toml").chain(), "w b A1 A2 A3 A4 A5 A6 t");
    EXPECT_EQ(abbe({"check", "--machine", "arm.machine.toml"}).exit_code, ExitCode::done);
  }
  ASSERT_EQ(abbe({"import", "--dh", examples + "arm.dh.toml", "-o", "again.machine.toml"}).exit_code, ExitCode::done);
  EXPECT_EQ(folder.read("again.machine.toml"), read_text_file(examples + "arm.machine.toml"));
  folder.write("b.dh.toml",
               "name = \"b\"\nconvention = \"standard\"\n[[joint]]\n"
               "travel_deg = [0, 90]\n[[joint]]\ntravel_deg = [0, 90]\ncoupled = { A3 = -1 }\n");
  const CommandResult coupled = abbe({"import", "--dh", "b.dh.toml", "-o", "b.machine.toml"});
  EXPECT_EQ(coupled.exit_code, ExitCode::bad_input);
  EXPECT_THAT(coupled.err, HasSubstr("b.dh.toml:7:13: joint[2].coupled.A3: there is no axis A3; expected one of A1"));
}

}  // namespace
}  // namespace abbe
