#include "abbe/formats/machine/dh_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/formats/text/replaced_text_for_test.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const std::string kDhExamples = ABBE_DOCS "/../examples/robot/";

const char* const kTwoJoints = R"(name = "two"
convention = "standard"
[base]
origin_mm = [0, 0, 100]
[tool]
angles_deg = [0, 90, 0]
[[joint]]
a_mm = 300
alpha_deg = 90
travel_deg = [-90, 90]
[[joint]]
kind = "linear"
theta_deg = 90
travel_mm = [0, 500]
reversed = true
)";

TEST(DhFile, TheTwoFormsOfTheExampleAreTheSameArm) {
  const DhArm toml = read_dh_arm(kDhExamples + "arm.dh.toml"), csv = read_dh_arm(kDhExamples + "arm.dh.csv");
  ASSERT_EQ(toml.joints.size(), 6U);
  ASSERT_EQ(csv.joints.size(), 6U);
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> angle(-2, 2);
  for (int i = 0; i < 20; ++i) {
    std::vector<double> commands(6);
    for (double& command : commands) command = angle(generator);
    const RigidTransform a = dh_pose(toml, commands), b = dh_pose(csv, commands);
    EXPECT_EQ(a.translation, b.translation);
    EXPECT_EQ(a.rotation, b.rotation);
  }
}

TEST(DhFile, TheMachineFileOfTheExampleIsWhatIsMadeOfItsTable) {
  Machine written = read_machine(kDhExamples + "arm.machine.toml");
  const Machine made = machine_from_dh(read_dh_arm(kDhExamples + "arm.dh.toml"));
  EXPECT_TRUE(written.bed_from_workpiece.rotation.isApprox(made.bed_from_workpiece.rotation, 1e-14));
  // About y by a right angle: the same rotation from its matrix and from its angles in deg, but for the last digit.
  written.bed_from_workpiece.rotation = made.bed_from_workpiece.rotation;
  EXPECT_EQ(machine_text(written), machine_text(made));
}

TEST(DhFile, MachineFileHasThePosesOfTheTable) {
  // The last frame of the example is turned by a right angle about y: a singular attitude of the three angles.
  for (const DhArm& arm : {read_dh_arm(kDhExamples + "arm.dh.toml"), parse_dh_arm(kTwoJoints, "two.dh.toml")}) {
    const Machine machine = parse_machine(dh_machine_text(arm, "arm.dh.toml"), "arm.machine.toml");
    std::mt19937_64 generator(5);
    std::uniform_real_distribution<double> angle(-2, 2);
    for (int i = 0; i < 50; ++i) {
      std::vector<double> commands(arm.joints.size());
      for (double& command : commands) command = angle(generator);
      const RigidTransform wanted = dh_pose(arm, commands), found = nominal_workpiece_from_tool(machine, commands);
      EXPECT_LE((wanted.translation - found.translation).norm(), 1e-12 * 1e3);
      EXPECT_LE((wanted.rotation - found.rotation).norm(), 1e-14);
    }
  }
}

TEST(DhFile, AnglesOfTheWorkpieceFrameComeBackNearTheirSingularAttitude) {
  std::mt19937_64 generator(11);
  std::uniform_real_distribution<double> any(-3, 3);
  for (const double off : {0.0, 1e-16, 1e-9, 1e-6, 1e-4, 1e-2}) {
    for (const double quarter : {90 * kDegree, -90 * kDegree}) {
      DhArm arm = parse_dh_arm(kTwoJoints, "two.dh.toml");
      for (DhJoint& joint : arm.joints) joint.alpha = joint.theta = 0;
      arm.last_from_tool.rotation =
          rotation_from_error_angles({any(generator), quarter + off, any(generator)}).transpose();
      const Machine machine = machine_from_dh(arm);
      const Machine back = parse_machine(machine_text(machine), "m.machine.toml");
      EXPECT_LE((back.bed_from_workpiece.rotation - machine.bed_from_workpiece.rotation).norm(), 1e-14) << off;
    }
  }
}

TEST(DhFile, MistakesAreNamed) {
  const auto message = [](const std::string& from, const std::string& to) {
    return message_of([&] { parse_dh_arm(test::replaced(kTwoJoints, from, to), "two.dh.toml"); });
  };
  EXPECT_THAT(message("standard", "craig"), HasSubstr("two.dh.toml:2:"));
  EXPECT_THAT(message("travel_mm = [0, 500]", "travel_mm = [500, 0]"),
              HasSubstr("two.dh.toml:14:1: joint[2].travel_mm: the first limit is not below the second"));
  EXPECT_THAT(message("a_mm = 300", "a = 300"), HasSubstr("joint[1].a"));
  EXPECT_THAT(message("reversed = true", "coupled_to = \"A2\""), HasSubstr("joint[2].coupled_to"));
  EXPECT_THAT(message("reversed = true", "endless = true"), HasSubstr("a linear joint cannot be endless"));
  EXPECT_THAT(message("reversed = true", "name = \"A2\""), HasSubstr("the letter stands for a rotary axis"));
  EXPECT_THAT(message("origin_mm = [0, 0, 100]\n[tool]\nangles_deg = [0, 90, 0]\n[[joint]]\na_mm = 300",
                      "origin_mm = [9e8, 0, 0]\n[[joint]]\na_mm = 9e8"),
              HasSubstr("the lengths add up to 1.8e+09 mm"));
  const auto csv = [](const std::string& rows) {
    return message_of(
        [&] { parse_dh_arm("convention,a_mm,alpha_deg,d_mm,theta_deg,smallest_deg,largest_deg\n" + rows, "t.csv"); });
  };
  EXPECT_THAT(csv("standard,0,0,0,0,-1,1\nmodified,0,0,0,0,-1,1\n"), HasSubstr("t.csv:3: convention: modified"));
  EXPECT_THAT(csv("standard,0,0,0,0,1,-1\n"), HasSubstr("t.csv:2: smallest_deg, largest_deg: the limits are missing"));
  EXPECT_THAT(csv("dh,0,0,0,0,1,-1\n"), HasSubstr("expected standard or modified"));
  EXPECT_TRUE(parse_dh_arm("convention,a_mm,alpha_deg,d_mm,theta_deg\nstandard,1,2,3,4\n", "t.csv").joints[0].endless);
}

}  // namespace
}  // namespace abbe
