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

/// Linear axes along x, y, z and rotary axes about them by their letters, free to turn by a quarter.
Machine chain_of(const std::vector<std::string>& names) {
  Machine machine;
  for (const std::string& name : names) {
    Axis axis{.name = name, .direction = direction_from_letter(name[0])};
    axis_kind_from_letter(name[0], axis.kind);
    if (axis.kind == AxisKind::rotary) axis.travel_max = std::numbers::pi / 2;
    machine.axes.push_back(axis);
  }
  return machine;
}

TEST(Machine, LinearAxesThatARotaryAxisTurnsApartAreNotRemarkedOn) {
  EXPECT_EQ(find_remarks(chain_of({"X", "Y", "Z", "W"})).size(), 1U);
  EXPECT_TRUE(find_remarks(chain_of({"Z", "B", "W"})).empty());
  // Across its axis B turns W out of the line of Z, but not out of the plane of X and Z.
  const std::string plane = "X, Z and W move in one plane: together they do not reach all places of space";
  EXPECT_EQ(find_remarks(chain_of({"X", "Y", "Z", "B", "W"})), std::vector<std::string>{plane});
  // A turn about their own direction leaves them parallel, and so does one before or behind both.
  EXPECT_EQ(find_remarks(chain_of({"X", "Y", "Z", "C", "W"})).size(), 1U);
  EXPECT_EQ(find_remarks(chain_of({"A", "X", "Y", "Z", "W", "B"})).size(), 1U);
  // Three in a plane: a turn about its normal or about the first one keeps them there, another one does not.
  EXPECT_EQ(find_remarks(chain_of({"X", "Y", "C", "U"})).size(), 1U);
  const auto in_plane = [](const std::string& rotary) {
    Machine machine = chain_of({"X", rotary, "Y", "W"});
    machine.axes[3].direction = Eigen::Vector3d(3, 4, 0) / 5;
    return find_remarks(machine).size();
  };
  EXPECT_EQ(in_plane("C"), 1U);
  EXPECT_EQ(in_plane("A"), 1U);
  EXPECT_EQ(in_plane("B"), 0U);
  EXPECT_TRUE(find_remarks(chain_of({"X", "C", "U"})).empty());
}

TEST(Machine, ARotaryAxisThatCannotTurnLeavesLinearAxesParallel) {
  Machine machine = chain_of({"Z", "B", "W"});
  machine.axes[1].travel_max = 0;
  EXPECT_EQ(find_remarks(machine).size(), 1U);
  machine.axes[1].endless = true;
  EXPECT_TRUE(find_remarks(machine).empty());
}

}  // namespace
}  // namespace abbe
