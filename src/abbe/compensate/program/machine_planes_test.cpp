#include "abbe/compensate/program/machine_planes.h"

#include <gtest/gtest.h>

#include <random>

#include "abbe/compensate/program/program_moves_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

std::vector<test::NamedMachine> machines_with_planes() {
  std::vector<test::NamedMachine> chosen;
  for (const test::NamedMachine& named : test::all_machines()) {
    if (MachinePlanes(named.machine, test::words_of(named.machine)).problem().empty()) chosen.push_back(named);
  }
  return chosen;
}

TEST(MachinePlanes, PlacesOfTheWorkpieceTurnWithIt) {
  std::mt19937_64 generator(5);
  std::size_t machines = 0;
  for (const test::NamedMachine& named : machines_with_planes()) {
    SCOPED_TRACE(named.name);
    ++machines;
    const WordAxes axes = test::words_of(named.machine);
    const MachinePlanes planes(named.machine, axes);
    const test::ControlledMachine control(named.machine, {}, axes);
    for (int i = 0; i < 20; ++i) {
      ProgramMove move;
      move.tool_length = {1, -2, 70};
      const WordValues zero = test::random_axis_words(named.machine, axes, generator);
      WordValues words = test::random_axis_words(named.machine, axes, generator);
      std::copy_n(zero.begin(), 3, words.begin());
      WordValues at_zero = words;
      std::copy_n(zero.begin() + 3, 3, at_zero.begin() + 3);
      planes.turn_with_workpiece(zero, move.tool_length, words);
      EXPECT_NEAR(control.point_missed(control.pose(move, words, false), control.pose(move, at_zero, false)), 0, 1e-9);
    }
  }
  EXPECT_GE(machines, 4U);
}

TEST(MachinePlanes, TheToolTurnsToWhereItHadBeenByTheNearestWay) {
  std::mt19937_64 generator(6);
  for (const test::NamedMachine& named : machines_with_planes()) {
    SCOPED_TRACE(named.name);
    const WordAxes axes = test::words_of(named.machine);
    const MachinePlanes planes(named.machine, axes);
    const test::ControlledMachine control(named.machine, {}, axes);
    for (int i = 0; i < 20; ++i) {
      const WordValues target = test::random_axis_words(named.machine, axes, generator);
      const Eigen::Vector3d direction = control.pose({}, target, false).rotation * named.machine.tool_direction;
      WordValues words = target;
      for (std::size_t k = 3; k < 6; ++k) words[k] += 1e-3;
      ASSERT_EQ(
          planes.turn_tool(ProgramCoordinates::tool_centre, {direction.x(), direction.y(), direction.z()}, {}, words),
          "");
      const RigidTransform there = control.pose({}, words, false);
      EXPECT_NEAR((there.rotation * named.machine.tool_direction - direction).norm(), 0, 1e-9);
      double turned = 0;
      for (std::size_t k = 3; k < 6; ++k) turned = std::max(turned, std::abs(words[k] - target[k]));
      EXPECT_LE(turned, 0.1);  // not by the other branch
    }
  }
}

TEST(MachinePlanes, MachinesWithoutThemSayWhy) {
  EXPECT_NE(MachinePlanes(test::three_axis_mill(), word_axes_by_name(test::three_axis_mill())).problem(), "");
  EXPECT_NE(MachinePlanes(test::three_axis_head(), test::words_of(test::three_axis_head())).problem(), "");
}

}  // namespace
}  // namespace abbe
