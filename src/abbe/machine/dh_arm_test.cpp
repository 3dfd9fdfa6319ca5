#include "abbe/machine/dh_arm.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/machine/machine_check.h"

namespace abbe {
namespace {

/// The matrices of a row as they stand in textbooks, whole.
Eigen::Matrix4d textbook_matrix(const DhJoint& joint, DhConvention convention, double command) {
  const double moved = joint.reversed ? -command : command;
  const double theta = joint.theta + (joint.kind == AxisKind::rotary ? moved : 0);
  const double d = joint.d + (joint.kind == AxisKind::linear ? moved : 0);
  const double ct = std::cos(theta), st = std::sin(theta), ca = std::cos(joint.alpha), sa = std::sin(joint.alpha);
  Eigen::Matrix4d m;
  if (convention == DhConvention::standard) {
    m << ct, -st * ca, st * sa, joint.a * ct, st, ct * ca, -ct * sa, joint.a * st, 0, sa, ca, d, 0, 0, 0, 1;
  } else {
    m << ct, -st, 0, joint.a, st * ca, ct * ca, -sa, -d * sa, st * sa, ct * sa, ca, d * ca, 0, 0, 0, 1;
  }
  return m;
}

Eigen::Matrix4d matrix_of(const RigidTransform& transform) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = transform.rotation;
  m.topRightCorner<3, 1>() = transform.translation;
  return m;
}

class RandomArms {
 public:
  double in(double from, double to) { return std::uniform_real_distribution<double>(from, to)(generator_); }
  DhArm arm(std::size_t count, DhConvention convention) {
    DhArm arm;
    arm.name = "random";
    arm.convention = convention;
    for (std::size_t i = 0; i < count; ++i) {
      DhJoint joint;
      joint.kind = in(0, 1) < 0.2 ? AxisKind::linear : AxisKind::rotary;
      joint.name = (joint.kind == AxisKind::linear ? "Z" : "A") + std::to_string(i + 1);
      joint.a = in(-500, 500);
      // Right angles as often as any others: arms have them.
      const double quarter = std::numbers::pi / 2;
      joint.alpha = in(0, 1) < 0.5 ? quarter * std::floor(in(-2, 3)) : in(-3, 3);
      joint.d = in(-500, 500);
      joint.theta = in(0, 1) < 0.5 ? quarter * std::floor(in(-2, 3)) : in(-3, 3);
      joint.reversed = in(0, 1) < 0.3;
      joint.travel_min = -3;
      joint.travel_max = 3;
      arm.joints.push_back(joint);
    }
    arm.workpiece_from_base = {rotation_from_error_angles({in(-3, 3), in(-3, 3), in(-3, 3)}),
                               {in(-9, 9), 7, in(-9, 9)}};
    arm.last_from_tool = {rotation_from_error_angles({in(-3, 3), in(-3, 3), in(-3, 3)}), {in(-90, 90), 0, in(0, 200)}};
    return arm;
  }

 private:
  std::mt19937_64 generator_{7};
};

TEST(DhArm, MachineHasThePoseOfTheProductOfItsMatrices) {
  RandomArms random;
  for (const DhConvention convention : {DhConvention::standard, DhConvention::modified}) {
    for (int k = 0; k < 200; ++k) {
      const DhArm arm = random.arm(k % 2 == 0 ? 6 : 7, convention);
      const Machine machine = machine_from_dh(arm);
      ASSERT_TRUE(find_problems(machine).empty()) << find_problems(machine).front().text();
      double reach = 1;
      for (const DhJoint& joint : arm.joints) reach += std::abs(joint.a) + std::abs(joint.d);
      for (int pose = 0; pose < 5; ++pose) {
        std::vector<double> commands;
        for (const DhJoint& joint : arm.joints)
          commands.push_back(random.in(-3, 3) * (joint.kind == AxisKind::linear ? 100 : 1));
        Eigen::Matrix4d product = matrix_of(arm.workpiece_from_base);
        for (std::size_t i = 0; i < commands.size(); ++i)
          product *= textbook_matrix(arm.joints[i], convention, commands[i]);
        product *= matrix_of(arm.last_from_tool);
        const Eigen::Matrix4d found = matrix_of(nominal_workpiece_from_tool(machine, commands));
        EXPECT_LE((found - product).topLeftCorner(3, 3).cwiseAbs().maxCoeff(), 1e-14 * 7);
        EXPECT_LE((found - product).topRightCorner(3, 1).cwiseAbs().maxCoeff(), 4e-15 * reach);
        EXPECT_LE((matrix_of(dh_pose(arm, commands)) - product).cwiseAbs().maxCoeff(), 4e-15 * reach);
      }
    }
  }
}

// J. Craig, Introduction to Robotics, 3.7 (Unimation PUMA 560): parameters a2, a3, d3, d4 and the equations of the
// point.
TEST(DhArm, PublishedArmStandsWhereItsEquationsSay) {
  constexpr double a2 = 431.8, a3 = -20.32, d3 = 149.09, d4 = 433.07;
  DhArm arm;
  arm.convention = DhConvention::modified;
  const double quarter = std::numbers::pi / 2;
  const double rows[6][3] = {{0, 0, 0},          {0, -quarter, 0}, {a2, 0, d3},
                             {a3, -quarter, d4}, {0, quarter, 0},  {0, -quarter, 0}};
  for (std::size_t i = 0; i < 6; ++i) {
    DhJoint joint;
    joint.name = "A" + std::to_string(i + 1);
    joint.a = rows[i][0];
    joint.alpha = rows[i][1];
    joint.d = rows[i][2];
    joint.travel_min = -3;
    joint.travel_max = 3;
    arm.joints.push_back(joint);
  }
  const Machine machine = machine_from_dh(arm);
  EXPECT_LE((nominal_workpiece_from_tool(machine, std::vector<double>(6, 0.0)).translation -
             Eigen::Vector3d(a2 + a3, d3, -d4))
                .norm(),
            1e-12);
  // px = c1 (a2 c2 + a3 c23 - d4 s23) - d3 s1, pz = -a3 s23 - a2 s2 - d4 c23.
  const double t1 = 0.3, t2 = -0.5, t3 = 0.9;
  const Eigen::Vector3d point =
      nominal_workpiece_from_tool(machine, std::vector<double>{t1, t2, t3, 0.4, -1, 2}).translation;
  const double forward = a2 * std::cos(t2) + a3 * std::cos(t2 + t3) - d4 * std::sin(t2 + t3);
  EXPECT_NEAR(point.x(), std::cos(t1) * forward - d3 * std::sin(t1), 1e-12 * 1e3);
  EXPECT_NEAR(point.y(), std::sin(t1) * forward + d3 * std::cos(t1), 1e-12 * 1e3);
  EXPECT_NEAR(point.z(), -a3 * std::sin(t2 + t3) - a2 * std::sin(t2) - d4 * std::cos(t2 + t3), 1e-12 * 1e3);
}

TEST(DhArm, RightAnglesAreExact) {
  DhArm arm;
  DhJoint joint;
  joint.name = "A1";
  joint.alpha = std::numbers::pi / 2;
  joint.d = 100;
  joint.a = 10;
  arm.joints = {joint, joint};
  arm.joints[1].name = "A2";
  const Machine machine = machine_from_dh(arm);
  const Eigen::Vector3d direction = machine.bed_from_workpiece.rotation.transpose() * machine.axes[1].direction;
  EXPECT_EQ(direction, Eigen::Vector3d(0, -1, 0));
}

}  // namespace
}  // namespace abbe
