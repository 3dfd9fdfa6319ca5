#include "abbe/machine/machine.h"

#include <gtest/gtest.h>

#include <numbers>

#include "abbe/machine/machine_check.h"

namespace abbe {
namespace {

Machine table_and_column() {
  Machine machine;
  Axis c{.name = "C", .kind = AxisKind::rotary, .side = ChainSide::workpiece, .primed = true};
  c.direction = Eigen::Vector3d::UnitZ();
  c.point = {700, 0, -100};
  Axis x{.name = "X", .kind = AxisKind::linear, .side = ChainSide::workpiece, .primed = true};
  Axis z{.name = "Z", .kind = AxisKind::linear, .side = ChainSide::tool};
  z.direction = Eigen::Vector3d::UnitZ();
  machine.axes = {c, x, z};
  machine.tool_reference = {0, 0, 300};
  return machine;
}

TEST(Machine, ChainIsWrittenFromWorkpieceToTool) { EXPECT_EQ(table_and_column().chain(), "w C' X' b Z t"); }

TEST(Machine, PrimedAxisMovesTheTableTheOtherWay) {
  const Machine machine = table_and_column();
  // Command X = +10 moves the table to -X, so the tool goes to +X on the workpiece.
  const Eigen::Vector3d tip = nominal_workpiece_from_tool(machine, {0, 10, 5}).translation;
  EXPECT_LE((tip - Eigen::Vector3d(10, 0, 305)).norm(), 1e-12);
}

TEST(Machine, PrimedRotaryTableTurnsTheToolInThePositiveSenseOnTheWorkpiece) {
  const Machine machine = table_and_column();
  const Eigen::Vector3d start = nominal_workpiece_from_tool(machine, {0, 800, 0}).translation - machine.axes[0].point;
  const Eigen::Vector3d turned =
      nominal_workpiece_from_tool(machine, {std::numbers::pi / 2, 800, 0}).translation - machine.axes[0].point;
  EXPECT_LE((turned - Eigen::Vector3d(-start.y(), start.x(), start.z())).norm(), 1e-10);
}

TEST(Machine, LinearAxesInOneLineOrPlaneAreRemarkedOn) {
  Machine machine;
  machine.axes = {Axis{.name = "X", .direction = Eigen::Vector3d::UnitX()},
                  Axis{.name = "Z", .direction = -Eigen::Vector3d::UnitX()},
                  Axis{.name = "Y", .direction = Eigen::Vector3d::UnitY()}};
  EXPECT_EQ(
      find_remarks(machine),
      std::vector<std::string>{"X and Z move along the same line: a pose leaves open how far each of them moves"});
  machine.axes[1].direction = Eigen::Vector3d(3, 4, 0) / 5;
  EXPECT_EQ(find_remarks(machine),
            std::vector<std::string>{"X, Z and Y move in one plane: together they do not reach all "
                                     "places of space"});
  machine.axes[1].direction = Eigen::Vector3d(3, 0, 4) / 5;
  EXPECT_TRUE(find_remarks(machine).empty());
}

}  // namespace
}  // namespace abbe
