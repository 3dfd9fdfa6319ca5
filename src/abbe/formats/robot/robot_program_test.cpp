#include "abbe/formats/robot/robot_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/formats/text/replaced_text_for_test.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using testing::HasSubstr;

RobotProgram robot_example(const std::string& name) {
  const std::string file = std::string(ABBE_DOCS "/../examples/robot/") + name;
  return parse_robot_program(read_text_file(file), *robot_language_of(name), name);
}

const std::vector<std::string> kRobotExamples = {"arm.mod", "arm.dat", "arm.src", "arm.ls", "arm.script"};

TEST(RobotProgram, PositionsAreFoundWithTheirLinesAndNames) {
  const auto names = [](const std::string& example) {
    std::string text;
    for (const RobotPosition& position : robot_example(example).positions) {
      text += std::to_string(position.line) + " " + position.name +
              (position.kind == RobotPositionKind::joints ? " joints\n" : " pose\n");
    }
    return text;
  };
  EXPECT_EQ(names("arm.mod"), "3 home joints\n4 p10 pose\n6 p{1} pose\n7 p{2} pose\n");
  EXPECT_EQ(names("arm.dat"), "4 XHOME joints\n5 XP1 pose\n7 XP2 pose\n");
  EXPECT_EQ(names("arm.src"), "5 PTP joints\n6 PTP pose\n7 LIN pose\n");
  EXPECT_EQ(names("arm.ls"), "12 P[1] joints\n18 P[2] pose\n24 P[3] pose\n");
  EXPECT_EQ(names("arm.script"), "4 movej joints\n5 movej pose\n6 movel pose\n");
}

TEST(RobotProgram, WhatIsNotReadIsListed) {
  const auto left = [](const std::string& example) {
    std::string text;
    for (const UncorrectedPosition& place : robot_example(example).left)
      text += std::to_string(place.line) + " " + place.reason + "\n";
    return text;
  };
  EXPECT_EQ(left("arm.mod"), "");
  EXPECT_EQ(left("arm.src"), "8 PTP is not given in full and in numbers\n");
  EXPECT_EQ(left("arm.script"), "8 movel: the position is not given in numbers\n");
  const RobotProgram rapid = parse_robot_program(
      "CONST jointtarget a:=[[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\nVAR robtarget here;\nVAR robtarget b:=a;\n"
      "MoveL [[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v10, fine, tool0;\nMoveL here, v10, fine, tool0;",
      RobotLanguage::rapid, "a.mod");
  ASSERT_EQ(rapid.left.size(), 2U);
  EXPECT_EQ(rapid.left[0].reason, "b is not given in numbers");
  EXPECT_EQ(rapid.left[1].line, 4U);
  const RobotProgram krl = parse_robot_program(
      "DECL AXIS H={A1 1,A2 2,A3 3,A4 4,A5 5,A6 6}\n$TOOL={X 1,Y 2,Z 3}\nXP1={X 1,Y 2}\n", RobotLanguage::krl, "a.src");
  ASSERT_EQ(krl.left.size(), 1U);
  EXPECT_EQ(krl.left[0].reason, "XP1 is not declared as a position in this file");
}

TEST(RobotProgram, ValuesComeInTheirUnits) {
  const RobotProgram rapid = robot_example("arm.mod");
  EXPECT_EQ(rapid.positions[0].joints[1]->value, -20);
  EXPECT_FALSE(rapid.positions[0].joints[6]);  // 9E9
  EXPECT_EQ(rapid.positions[1].pose[6].value, 0.078989928);
  EXPECT_EQ(rapid.positions[1].pose[6].decimals, 9U);
  EXPECT_NEAR(rapid.positions[1].configuration[5]->from, -90 * kDegree, 1e-15);
  EXPECT_NEAR(rapid.positions[1].configuration[5]->to, 0, 1e-15);
  EXPECT_FALSE(rapid.positions[1].configuration[1]);
  const RobotProgram krl = robot_example("arm.dat");
  EXPECT_EQ(krl.positions[0].joints[5]->value, -1);
  EXPECT_EQ(krl.positions[0].joints[11]->value, 0);
  EXPECT_EQ(krl.positions[2].pose[3].value, 86.8982757);
  // T = B1001: A1 and A4 are below zero.
  EXPECT_EQ(krl.positions[2].configuration[3]->to, 0);
  EXPECT_EQ(krl.positions[2].configuration[4]->from, 0);
  const RobotProgram ls = robot_example("arm.ls");
  EXPECT_EQ(ls.positions[2].pose[2].value, 589.372);
  EXPECT_EQ(ls.positions[2].frame, "UF 0, UT 1");
  const RobotProgram ur = robot_example("arm.script");
  EXPECT_EQ(ur.positions[0].joints[2]->value, 0.524);
  EXPECT_NEAR(robot_pose(ur, ur.positions[1]).translation.x(), 238.198, 1e-12);
}

// One orientation in the conventions of the four controls. Source of the numbers: scipy 1.17.1,
// Rotation.from_euler("ZYX", [A, B, C], degrees=True) (intrinsic) and its as_quat(), as_rotvec(), as_matrix();
// from_euler("xyz", [W, P, R]) (extrinsic) gives the same.
struct SameRotation {
  double abc[3], quaternion[4], vector[3], matrix[9];
};
constexpr SameRotation kSameRotations[] = {
    {{10, 20, 30},
     {0.9515485246437885, 0.2392983377447303, 0.18930785741199999, 0.03813457647485015},
     {0.4864792299807579, 0.3848515688451535, 0.0775253166151003},
     {0.9254165783983233, 0.018028311236297265, 0.37852230636979245, 0.1631759111665348, 0.8825641192593854,
      -0.44096961052988237, -0.34202014332566866, 0.4698463103929541, 0.8137976813493736}},
    {{-144.25, 31.28, -179.53},
     {0.25778868366680746, -0.29452190088106417, 0.9168219756461117, 0.0789892995734206},
     {-0.7986790789483418, 2.486220986887954, 0.2142017311491904},
     {-0.6936036889494783, -0.5807733971952415, 0.4261645031979705, -0.4993232069520606, 0.8140350809086097,
      0.29668707765796304, -0.5192208178364812, -0.007010574898738853, -0.8546113702524698}},
    {{86.9, -50.2, 155.1},
     {-0.1431391891112055, 0.7048541401628287, 0.5417420758988435, 0.43497969703966405},
     {-2.03281740172547, -1.5623980287320807, -1.254492592375544},
     {0.0346163727281877, 0.8882235724236011, 0.45810543778719703, 0.6391730079672197, -0.37205339148279665,
      0.6730781082254018, 0.7682835235935234, 0.26950910796706873, -0.5806076714077373}}};

RobotPosition position_with(const std::vector<double>& numbers) {
  RobotPosition position;
  position.kind = RobotPositionKind::pose;
  for (const double value : numbers) position.pose.push_back({.value = value});
  return position;
}

TEST(RobotProgram, OrientationsAreThoseOfScipy) {
  for (const SameRotation& same : kSameRotations) {
    const Eigen::Matrix3d matrix = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(same.matrix);
    const auto& q = same.quaternion;
    const auto& v = same.vector;
    const auto& a = same.abc;
    const std::pair<RobotLanguage, std::vector<double>> numbers[] = {
        {RobotLanguage::rapid, {1, 2, 3, q[0], q[1], q[2], q[3]}},
        {RobotLanguage::krl, {1, 2, 3, a[0], a[1], a[2]}},
        {RobotLanguage::fanuc_ls, {1, 2, 3, a[2], a[1], a[0]}},
        {RobotLanguage::urscript, {0.001, 0.002, 0.003, v[0], v[1], v[2]}}};
    for (const auto& [language, values] : numbers) {
      RobotProgram program;
      program.language = language;
      const RobotPosition position = position_with(values);
      const RigidTransform pose = robot_pose(program, position);
      EXPECT_LE((pose.rotation - matrix).cwiseAbs().maxCoeff(), 1e-14) << robot_language_name(language);
      EXPECT_LE((pose.translation - Eigen::Vector3d(1, 2, 3)).norm(), 1e-14);
      // And back to the same numbers, not to others of the same rotation.
      const std::vector<double> back = robot_pose_numbers(language, position, pose);
      for (std::size_t i = 0; i < back.size(); ++i) EXPECT_NEAR(back[i], values[i], 1e-12 * 180);
    }
  }
}

TEST(RobotProgram, NumbersOfAPoseStayNearThoseBefore) {
  std::mt19937_64 generator(4);
  std::uniform_real_distribution<double> angle(-400, 400), small(-1e-3, 1e-3);
  for (int i = 0; i < 400; ++i) {
    const double b = i % 4 == 0 ? (i % 8 == 0 ? 90 : -90) : angle(generator);
    for (const RobotLanguage language : {RobotLanguage::krl, RobotLanguage::fanuc_ls, RobotLanguage::urscript}) {
      const bool ur = language == RobotLanguage::urscript;
      const double unit = ur ? kDegree : 1;
      const RobotPosition position =
          position_with({100, 200, 300, unit * angle(generator), unit * b, unit * angle(generator)});
      RobotProgram program;
      program.language = language;
      RigidTransform pose = robot_pose(program, position);
      const bool is_singular = !ur && i % 4 == 0;
      if (!is_singular)
        pose.rotation = rotation_from_vector({small(generator), small(generator), small(generator)}) * pose.rotation;
      const std::vector<double> numbers = robot_pose_numbers(language, position, pose);
      const RobotPosition written = position_with(numbers);
      EXPECT_LE((robot_pose(program, written).rotation - pose.rotation).norm(), 1e-13);
      // A rotation of 1 mrad changes angles by that over the cosine of the middle one.
      // Rotation vectors near a whole turn change their line.
      const double half =
          0.5 * Eigen::Vector3d(position.pose[3].value, position.pose[4].value, position.pose[5].value).norm();
      const double of_vector = std::abs(std::sin(half)) > 0.2 ? 0.01 * (1 + half) / std::abs(std::sin(half)) : 2;
      const double bound = ur ? of_vector : is_singular ? 1e-6 : 0.2 / std::abs(std::cos(b * kDegree));
      for (std::size_t k = 3; k < 6; ++k) {
        if (bound < 1) {
          EXPECT_NEAR(numbers[k], position.pose[k].value, bound) << i;
        }
      }
    }
  }
}

TEST(RobotProgram, OnlyNumbersOfPositionsChange) {
  for (const std::string& name : kRobotExamples) {
    const RobotProgram program = robot_example(name);
    // Nothing asked for, or the numbers that stand there: the same bytes.
    EXPECT_EQ(replaced_robot_text(program, std::vector<RobotValues>(program.positions.size())), program.text);
    std::vector<RobotValues> same, other;
    for (const RobotPosition& position : program.positions) {
      RobotValues values;
      if (position.kind == RobotPositionKind::joints) {
        for (const auto& number : position.joints) values.push_back(number ? number->value : 0);
      } else {
        for (const RobotNumber& number : position.pose) values.push_back(number.value);
      }
      same.push_back(values);
      for (double& value : values) value += 0.125;
      other.push_back(values);
    }
    EXPECT_EQ(replaced_robot_text(program, same), program.text) << name;
    const std::string changed = replaced_robot_text(program, other);
    // What lies between the numbers is in both texts, in order.
    std::size_t at = 0, done = 0;
    std::vector<RobotNumber> numbers;
    for (const RobotPosition& position : program.positions) {
      for (const auto& number : position.joints) {
        if (number && position.kind == RobotPositionKind::joints) numbers.push_back(*number);
      }
      for (const RobotNumber& number : position.pose) numbers.push_back(number);
    }
    std::sort(numbers.begin(), numbers.end(), [](const auto& a, const auto& b) { return a.begin < b.begin; });
    for (const RobotNumber& number : numbers) {
      const std::string between = program.text.substr(done, number.begin - done);
      ASSERT_EQ(changed.substr(at, between.size()), between) << name;
      at += between.size();
      while (at < changed.size() &&
             (std::isdigit(static_cast<unsigned char>(changed[at])) != 0 || changed[at] == '.' || changed[at] == '-'))
        ++at;
      done = number.begin + number.size;
    }
    EXPECT_EQ(changed.substr(at), program.text.substr(done)) << name;
    if (name == "arm.mod") continue;  // a quaternion of any length is refused
    const RobotProgram back = parse_robot_program(changed, program.language, name);
    ASSERT_EQ(back.positions.size(), program.positions.size());
    for (std::size_t k = 0; k < back.positions.size(); ++k) {
      for (std::size_t i = 0; i < back.positions[k].pose.size(); ++i)
        EXPECT_NEAR(back.positions[k].pose[i].value, other[k][i], 1e-9);
    }
  }
}

TEST(RobotProgram, NumbersHaveTheDigitsOfTheirLanguage) {
  const RobotProgram ls = robot_example("arm.ls"), ur = robot_example("arm.script"), krl = robot_example("arm.dat");
  EXPECT_EQ(robot_number_text(ls.language, ls.positions[1], 0, 1234.56789), "1234.568");
  EXPECT_EQ(robot_number_text(ls.language, ls.positions[1], 0, -1e-9), "0.000");
  EXPECT_EQ(robot_number_text(ur.language, ur.positions[1], 0, 0.23819812345), "0.2381981");
  EXPECT_EQ(robot_number_text(ur.language, ur.positions[1], 3, 0.5), "0.50000000");
  EXPECT_EQ(robot_number_text(krl.language, krl.positions[1], 4, 31.28518444), "31.2851844");
  EXPECT_EQ(robot_number_text(krl.language, krl.positions[1], 0, 238.1), "238.1000");
}

TEST(RobotProgram, LineEndsBytesAndCommentsOfAnyKindAreKept) {
  const std::string text =
      "DEFDAT A \xE4\r\n;DECL E6POS XP0={X 1}\r\nDECL CHAR T[9]\r\nT[]=\"DECL POS P={\"\r\nDECL POS XP1={X 1.5,Y 2,Z "
      "3,A 4,B 5,C "
      "6}\r\nENDDAT";
  const RobotProgram program = parse_robot_program(text, RobotLanguage::krl, "a.dat");
  ASSERT_EQ(program.positions.size(), 1U);
  EXPECT_EQ(program.positions[0].line, 5U);
  EXPECT_EQ(replaced_robot_text(program, {{1.75, 2, 3, 4, 5, 6}}), test::replaced(text, "X 1.5", "X 1.7500"));
}

TEST(RobotProgram, ConfigurationsFollowJointsThatLeaveTheirRange) {
  const RobotProgram rapid = robot_example("arm.mod"), krl = robot_example("arm.dat");
  const auto changed = [](const RobotProgram& program, std::size_t k, std::vector<double> arm) {
    for (double& angle : arm) angle *= kDegree;
    std::vector<RobotValues> values(program.positions.size());
    for (const RobotNumber& number : program.positions[k].pose) values[k].push_back(number.value);
    std::vector<std::vector<double>> arms(values.size());
    arms[k] = arm;
    return replaced_robot_text(program, values, arms);
  };
  EXPECT_EQ(changed(rapid, 1, {20, -30, 40, 10, 50, -20}), rapid.text);
  EXPECT_EQ(changed(rapid, 1, {-0.01, -30, 40, 90.01, 50, 0.01}),
            test::replaced(rapid.text, "[0,0,-1,0]", "[-1,1,0,0]"));
  EXPECT_EQ(changed(krl, 1, {20, -30, 40, 10, 50, -20}), krl.text);
  EXPECT_EQ(changed(krl, 1, {-0.01, -30, 40, 10, 50, -20}), test::replaced(krl.text, "T 34", "T 35"));
  EXPECT_EQ(changed(krl, 2, {-35, 10, 25, 0.01, 70, 100}), test::replaced(krl.text, "'B1001'", "'B1'"));
}

TEST(RobotProgram, SeveralGroupsOfFanucAreListed) {
  const std::string text =
      "/PROG A\n/POS\nP[1]{\n   GP1:\n\tUF : 0, UT : 2,\t\tCONFIG : 'N U T, 0, 0, 0',\n\tX =  1.0  mm,\tY = .5  mm,\tZ "
      "= -3  mm,\n"
      "\tW = 1 deg,\tP = 2 deg,\tR = 3 deg\n   GP2:\n\tUF : 0, UT : 2,\t\n\tJ1=     0.000  mm\n};\nP[2]{\n   "
      "GP1:\n\tUF : 0, UT : "
      "2,\n\tJ1= ******** deg,\tJ2= ******** deg\n};\n/END\n";
  const RobotProgram program = parse_robot_program(text, RobotLanguage::fanuc_ls, "a.ls");
  ASSERT_EQ(program.positions.size(), 1U);
  EXPECT_EQ(program.positions[0].pose[1].value, 0.5);
  ASSERT_EQ(program.left.size(), 2U);
  EXPECT_EQ(program.left[0].reason, "P[1]: GP2 is not of the arm");
  EXPECT_EQ(program.left[1].reason, "P[2]: GP1 has no numbers");
}

TEST(RobotProgram, AFileThatEndsAnywhereIsReadOrRefused) {
  const std::string frame = "DEFDAT A\nDECL FDAT FP1={TOOL_NO 1,BASE_NO 0,IPO_FRAME #BASE,POINT2[] \" \"}\nENDDAT\n";
  const std::string array = "MODULE m\n  CONST robtarget p{2,3} := [];\nENDMODULE\n";
  std::vector<std::pair<std::string, RobotLanguage>> programs = {{frame, RobotLanguage::krl},
                                                                 {array, RobotLanguage::rapid}};
  for (const std::string& example : kRobotExamples) {
    programs.emplace_back(robot_example(example).text, *robot_language_of(example));
  }
  for (const auto& [text, language] : programs) {
    std::size_t refused = 0;
    for (std::size_t size = 0; size < text.size(); ++size) {
      for (const char* const ending : {"", "  \t ", "{", "\" \""}) {
        try {
          parse_robot_program(text.substr(0, size) + ending, language, "cut");
        } catch (const InputError&) {
          ++refused;
        }
      }
    }
    EXPECT_GT(refused, 0U);
  }
}

TEST(RobotProgram, MistakesAreNamedWithTheirPlace) {
  const auto message = [](const std::string& example, const std::string& from, const std::string& to) {
    const RobotProgram program = robot_example(example);
    return message_of([&] { parse_robot_program(test::replaced(program.text, from, to), program.language, example); });
  };
  EXPECT_THAT(message("arm.mod", "238.198", "2x8.198"), HasSubstr("arm.mod:4:27: p10.trans: found 'x'"));
  EXPECT_THAT(message("arm.mod", "[0, 0, 0, 1]", "[0, 0, 0]"), HasSubstr("arm.mod:7:"));
  EXPECT_THAT(message("arm.mod", "0.257834160", "0.9"), HasSubstr("p10.rot: the quaternion has the length"));
  EXPECT_THAT(message("arm.mod", "238.198", "1e400"), HasSubstr("p10.trans: '1e400' is too large"));
  EXPECT_THAT(message("arm.dat", "Y 98.022", "X 98.022"), HasSubstr("arm.dat:5:29: XP1.X: is given twice"));
  EXPECT_THAT(message("arm.dat", "'B1001'", "'B1021'"), HasSubstr("XP2.T: is no number; expected a whole number"));
  EXPECT_THAT(message("arm.ls", "238.198  mm", "238.198 deg"),
              HasSubstr("arm.ls:21:8: P[2].X: has the wrong unit; expected mm"));
  EXPECT_THAT(message("arm.ls", "589.372  mm", "589.372"), HasSubstr("P[3].Z: has no unit; expected mm or deg"));
  EXPECT_THAT(message("arm.ls", "};\n/END", ""), HasSubstr("the file ends here"));
  EXPECT_THAT(message_of([] { parse_robot_program("def a():\nend\n", RobotLanguage::urscript, "a.script"); }),
              HasSubstr("a.script: no position in this file; expected a position of URScript given in numbers"));
  EXPECT_FALSE(robot_language_of("poses.csv"));
  EXPECT_FALSE(robot_language_of("mod"));
  EXPECT_EQ(robot_language_of("A.LS"), RobotLanguage::fanuc_ls);
}

}  // namespace
}  // namespace abbe
