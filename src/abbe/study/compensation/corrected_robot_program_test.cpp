#include "abbe/study/compensation/corrected_robot_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <nlohmann/json.hpp>
#include <string>

#include "abbe/errors/actual_pose.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/formats/text/replaced_text_for_test.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using testing::HasSubstr;

RobotProgramRequest robot_request(const std::string& name) {
  const std::string folder = ABBE_SOURCE_DIR "/examples/robot/";
  RobotProgramRequest request;
  request.machine_file = "arm.machine.toml";
  request.machine = read_machine(folder + "arm.machine.toml");
  request.errors = read_errors(folder + "arm.errors.toml", request.machine);
  request.program = parse_robot_program(read_text_file(folder + name), *robot_language_of(name), name);
  return request;
}

/// Commands of a nominal arm near others, by Newton's method and the derivatives of the deviation.
std::vector<double> nominal_commands(const Machine& machine, const RigidTransform& wanted,
                                     std::vector<double> commands) {
  for (int i = 0; i < 30; ++i) {
    const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
    Deviation deviation;
    Eigen::MatrixXd by_positions;
    tool_deviation(machine, ErrorSet{}, commands, deviation, nullptr, &by_positions);
    Eigen::Matrix<double, 6, 1> missing;
    missing << wanted.translation - pose.translation, rotation_vector(wanted.rotation * pose.rotation.transpose());
    const Eigen::VectorXd step = by_positions.fullPivLu().solve(missing);
    for (std::size_t k = 0; k < commands.size(); ++k) commands[k] += step[static_cast<Eigen::Index>(k)];
  }
  EXPECT_LE((nominal_workpiece_from_tool(machine, commands).translation - wanted.translation).norm(), 1e-9);
  return commands;
}

/// Commands that a control with the nominal kinematics takes for a corrected position; the search starts nearby.
std::vector<double> commands_of_control(const RobotProgramRequest& request, const RobotProgram& corrected,
                                        std::size_t k, const std::vector<double>& near) {
  const RobotPosition& position = corrected.positions[k];
  if (position.kind == RobotPositionKind::joints) {
    std::vector<double> commands;
    for (std::size_t i = 0; i < 6; ++i)
      commands.push_back(position.joints[i]->value * robot_joint_unit(corrected.language, false));
    return commands;
  }
  return nominal_commands(request.machine, robot_pose(corrected, position), near);
}

TEST(CorrectedRobotPositions, BringTheActualToolToTheNominalPoseInEveryLanguage) {
  for (const std::string name : {"arm.mod", "arm.dat", "arm.src", "arm.ls", "arm.script"}) {
    const RobotProgramRequest request = robot_request(name);
    const CorrectedRobotProgram result = correct_robot_program(request);
    ASSERT_EQ(result.refused, "") << name;
    const RobotProgram corrected = parse_robot_program(result.text, request.program.language, name);
    ASSERT_EQ(corrected.positions.size(), request.program.positions.size());
    // Fanuc lists three digits: 0.5 um in each coordinate, and 0.0005 degrees at a reach of up to 1 m.
    const bool coarse = request.program.language == RobotLanguage::fanuc_ls;
    for (std::size_t k = 0; k < corrected.positions.size(); ++k) {
      const RobotPosition& before = request.program.positions[k];
      const CorrectedRobotPosition& position = result.positions[k];
      const RigidTransform wanted = before.kind == RobotPositionKind::joints
                                        ? nominal_workpiece_from_tool(request.machine, position.nominal)
                                        : robot_pose(request.program, before);
      const std::vector<double> commands = commands_of_control(request, corrected, k, position.corrected);
      const RigidTransform actual = actual_workpiece_from_tool(request.machine, request.errors.errors, commands);
      const double left = (actual.translation - wanted.translation).norm();
      EXPECT_NEAR(left, position.position_left, 1e-7) << name << k;
      EXPECT_LE(left, coarse ? 0.02 : 2e-4) << name << k;
      EXPECT_LE(rotation_vector(actual.rotation * wanted.rotation.transpose()).norm(), coarse ? 4e-5 : 2e-7);
      // Uncorrected, the tool is off by far more.
      const RigidTransform off = actual_workpiece_from_tool(request.machine, request.errors.errors, position.nominal);
      EXPECT_GE((off.translation - wanted.translation).norm(), 0.1);
      EXPECT_NEAR((off.translation - wanted.translation).norm(), position.shift, 1e-6);
    }
  }
}

// Another route to a Cartesian target: the error at the corrected commands, taken off the wanted pose.
TEST(CorrectedRobotPositions, ACartesianTargetIsThePoseLessTheErrorWhereTheArmThenStands) {
  const RobotProgramRequest request = robot_request("arm.dat");
  const CorrectedRobotProgram result = correct_robot_program(request);
  const RobotProgram corrected = parse_robot_program(result.text, RobotLanguage::krl, "out.dat");
  const RigidTransform wanted = robot_pose(request.program, request.program.positions[1]);
  RigidTransform target = wanted;
  std::vector<double> commands = result.positions[1].nominal;
  for (int i = 0; i < 20; ++i) {
    commands = nominal_commands(request.machine, target, commands);
    const RigidTransform actual = actual_workpiece_from_tool(request.machine, request.errors.errors, commands);
    const RigidTransform error = nominal_workpiece_from_tool(request.machine, commands).inverse() * actual;
    target = wanted * error.inverse();
  }
  const RigidTransform written = robot_pose(corrected, corrected.positions[1]);
  EXPECT_LE((written.translation - target.translation).norm(), 1e-4);
  EXPECT_LE((written.rotation - target.rotation).norm(), 1e-7);
}

TEST(CorrectedRobotPositions, WithoutErrorsEveryByteStays) {
  for (const std::string name : {"arm.mod", "arm.dat", "arm.src", "arm.ls", "arm.script"}) {
    RobotProgramRequest request = robot_request(name);
    request.errors = {};
    const CorrectedRobotProgram result = correct_robot_program(request);
    EXPECT_EQ(result.refused, "");
    EXPECT_EQ(result.text, request.program.text) << name;
  }
}

/// A control that counts joint 3 from the horizontal: the same arm and program, the numbers of joint 3 without those of
/// joint 2. What comes out is the same but for these.
TEST(CorrectedRobotPositions, CoupledJointsAreThoseOfTheControl) {
  RobotProgramRequest free = robot_request("arm.ls");
  for (Axis& axis : free.machine.axes) {
    if (axis.name == "A3") axis.travel_min = -4, axis.travel_max = 4;
  }
  RobotProgramRequest coupled = free;
  coupled.machine.couplings = {{2, 1, 1.0}};
  const std::string program = test::replaced(free.program.text, "J3=    30.000", "J3=    50.000");
  coupled.program = parse_robot_program(program, RobotLanguage::fanuc_ls, "arm.ls");
  const CorrectedRobotProgram expected = correct_robot_program(free), found = correct_robot_program(coupled);
  ASSERT_EQ(found.refused, "");
  ASSERT_EQ(found.positions.size(), expected.positions.size());
  for (std::size_t k = 0; k < found.positions.size(); ++k) {
    for (std::size_t i = 0; i < 6; ++i) {
      const double part = i == 2 ? found.positions[k].corrected[1] : 0;
      EXPECT_NEAR(found.positions[k].corrected[i] + part, expected.positions[k].corrected[i], 1e-9) << k << i;
    }
  }
  const RobotProgram before = parse_robot_program(expected.text, RobotLanguage::fanuc_ls, "arm.ls");
  const RobotProgram after = parse_robot_program(found.text, RobotLanguage::fanuc_ls, "arm.ls");
  EXPECT_NEAR(after.positions[0].joints[2]->value + after.positions[0].joints[1]->value,
              before.positions[0].joints[2]->value, 0.0011);
  for (const std::size_t k : {std::size_t{1}, std::size_t{2}}) {
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(after.positions[k].pose[i].value, before.positions[k].pose[i].value, 0.0011);
  }
}

TEST(CorrectedRobotPositions, ConfigurationChoosesTheAxes) {
  const CorrectedRobotProgram result = correct_robot_program(robot_request("arm.mod"));
  const double wanted[3][6] = {{20, -30, 40, 10, 50, -20}, {-35, 10, 25, -60, 70, 100}, {60, -20, 60, 30, -45, 15}};
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(result.positions[k + 1].nominal[i] / kDegree, wanted[k][i], 1e-3) << k << i;
  }
  RobotProgramRequest other = robot_request("arm.mod");
  other.program = parse_robot_program(test::replaced(other.program.text, "[0,0,-1,0]", "[-1,0,-1,0]"),
                                      RobotLanguage::rapid, "other.mod");
  EXPECT_THAT(correct_robot_program(other).refused,
              HasSubstr("line 4, p10: no axis positions with this pose have the configuration"));
}

// A4 at zero, as in programs that keep the wrist upright: the correction takes it below, and T has to say so.
TEST(CorrectedRobotPositions, TurnsFollowAJointThatPassesZero) {
  RobotProgramRequest request = robot_request("arm.dat");
  const std::vector<double> commands = {0.3, -0.2, 0.7, 0, 0.8, 0.4};
  RobotPosition& first = request.program.positions[1];
  const RigidTransform pose = nominal_workpiece_from_tool(request.machine, commands);
  const std::vector<double> numbers = robot_pose_numbers(RobotLanguage::krl, first, pose);
  std::vector<RobotValues> values(request.program.positions.size());
  values[1] = numbers;
  const std::string upright = test::replaced(replaced_robot_text(request.program, values), "T 34", "T 2");
  request.program = parse_robot_program(upright, RobotLanguage::krl, "upright.dat");
  const CorrectedRobotProgram result = correct_robot_program(request);
  ASSERT_EQ(result.refused, "");
  const double joint = result.positions[1].corrected[3];
  EXPECT_GT(std::abs(joint), 1e-5);
  EXPECT_THAT(result.text, HasSubstr(joint < 0 ? "S 6,T 10,E1" : "S 6,T 2,E1"));
}

TEST(CorrectedRobotPositions, WithoutAPositionBeforeSeveralBranchesAreNotChosenFrom) {
  RobotProgramRequest request = robot_request("arm.script");
  request.program = parse_robot_program("movej(p[0.238198, 0.098022, 0.687212, -0.798592, 2.486150, 0.214198])\n",
                                        RobotLanguage::urscript, "one.script");
  const CorrectedRobotProgram result = correct_robot_program(request);
  EXPECT_THAT(result.refused, HasSubstr("line 1, movej: "));
  EXPECT_THAT(result.refused, HasSubstr("no position before it says which one is near"));
  EXPECT_EQ(result.text, "");
}

TEST(CorrectedRobotPositions, WhatDoesNotFitIsNamed) {
  const auto problem = [](const std::string& name, const auto& change) {
    RobotProgramRequest request = robot_request(name);
    change(request);
    return message_of([&] { correct_robot_program(request); });
  };
  const auto with_text = [](const std::string& from, const std::string& to) {
    return [from, to](RobotProgramRequest& r) {
      r.program = parse_robot_program(test::replaced(r.program.text, from, to), r.program.language, r.program.file);
    };
  };
  EXPECT_THAT(problem("arm.ls", with_text("UT : 1,\t\tCONFIG : 'N U T, 0, 0, 0',\n\tX =   346",
                                          "UT : 2,\t\tCONFIG : 'N U T, 0, 0, 0',\n\tX =   346")),
              HasSubstr("arm.ls:24: P[3]: is in UF 0, UT 2, but P[2] is in UF 0, UT 1"));
  EXPECT_THAT(problem("arm.dat", with_text("FP2={TOOL_NO 1", "FP2={TOOL_NO 3")), HasSubstr("several tools or bases"));
  EXPECT_THAT(problem("arm.ls", with_text("J2=   -20.000 deg", "J2=   -20.000  mm")),
              HasSubstr("joint 2 has the wrong unit for axis A2; expected deg"));
  EXPECT_THAT(problem("arm.mod", with_text("[0, -20, 30", "[0, -120, 30")),
              HasSubstr("arm.mod:3: home: joint 2 is outside the travel of axis A2"));
  EXPECT_THAT(problem("arm.mod", [](RobotProgramRequest& r) { r.machine.axes[5].name = "A5"; }), HasSubstr("axis A5"));
  EXPECT_THAT(problem("arm.mod", [](RobotProgramRequest& r) { r.machine.axes[5].name = "A"; }),
              HasSubstr("the name says no joint"));
  EXPECT_THAT(problem("arm.mod", [](RobotProgramRequest& r) { r.machine.axes[5].name = "A7"; }),
              HasSubstr("has no value of joint 7"));
  EXPECT_THAT(problem("arm.mod", [](RobotProgramRequest& r) { r.leave_out_factor = 2; }),
              HasSubstr("--leave-out-below-uncertainty"));
  EXPECT_THAT(problem("arm.mod", [](RobotProgramRequest& r) { r.limit_um = -1; }), HasSubstr("--limit-um"));
  RobotProgramRequest limited = robot_request("arm.mod");
  limited.limit_um = 1;
  EXPECT_THAT(correct_robot_program(limited).refused, HasSubstr("um above --limit-um 1"));
}

TEST(CorrectedRobotPositions, TextAndJsonSayWhatWasDone) {
  const RobotProgramRequest request = robot_request("arm.script");
  const CorrectedRobotProgram result = correct_robot_program(request);
  const std::string text = corrected_robot_text(request, result, "out.script", true);
  EXPECT_THAT(text, HasSubstr("URScript program for six-axis arm: 1 joint positions, 2 Cartesian positions"));
  EXPECT_THAT(text, HasSubstr("largest correction of the functional point"));
  EXPECT_THAT(text, HasSubstr("1 places are left as they are:\n  line 8: movel: the position is not given in numbers"));
  EXPECT_THAT(text, HasSubstr("out.script written"));
  const nlohmann::ordered_json json = corrected_robot_json(request, result, "out.script", true);
  EXPECT_EQ(json["positions"].size(), 3U);
  EXPECT_NEAR(json["positions"][0]["commands"]["A2_deg"].get<double>(), -0.349 / kDegree, 1e-9);
  EXPECT_GT(json["positions"][1]["correction_um"].get<double>(), 100);
  EXPECT_EQ(json["left_as_they_are"][0]["line"], 8);
}

}  // namespace
}  // namespace abbe
