#include "abbe/machine/machine.h"

#include <gtest/gtest.h>

#include <numbers>

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

}  // namespace
}  // namespace abbe
