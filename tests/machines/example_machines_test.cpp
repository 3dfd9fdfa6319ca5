#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <random>
#include <string>

#include "abbe/formats/machine/machine_file.h"
#include "abbe/machine/drawing.h"
#include "abbe/machine/inverse_kinematics.h"
#include "abbe/machine/machine_check.h"
#include "abbe/machine/machines_for_test.h"

/// The machine files of examples/machines, through the file reader.
namespace abbe {
namespace {

const std::map<std::string, Machine>& machines_in_code() {
  static const std::map<std::string, Machine> machines = {
      {"aguado", test::aguado_table()},
      {"wang-grinder", test::wang_grinder()},
      {"yin-engraver-u", test::yin_engraver('U')},
      {"yin-engraver-p", test::yin_engraver('P')},
      {"liu-scanner", test::liu_scanner()},
      {"trunnion-mill", test::trunnion_mill()},
      {"swivel-head-mill", test::swivel_head_mill()},
      {"head-table-mill", test::head_table_mill()},
      {"gantry-fork-head", test::gantry_fork_head()},
      {"lathe", test::lathe()},
      {"three-axis-mill", test::three_axis_mill()},
      {"moving-table-cmm", test::moving_table_cmm()},
      {"nutating-head-mill", test::nutating_head_mill()},
      {"jointed-arm", test::jointed_arm()},
      {"parallel-axes-arm", test::parallel_axes_arm()},
      {"seven-axis-arm", test::seven_axis_arm()},
  };
  return machines;
}

std::vector<std::string> example_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(ABBE_EXAMPLE_MACHINES)) {
    const std::string file = entry.path().filename().string();
    const std::size_t end = file.find(".machine.toml");
    if (end != std::string::npos) names.push_back(file.substr(0, end));
  }
  std::sort(names.begin(), names.end());
  return names;
}

Machine read_example(const std::string& name) {
  return read_machine(std::filesystem::path(ABBE_EXAMPLE_MACHINES) / (name + ".machine.toml"));
}

TEST(ExampleMachines, AreAllThere) {
  const std::vector<std::string> names = example_names();
  for (const auto& machine : machines_in_code()) {
    EXPECT_TRUE(std::find(names.begin(), names.end(), machine.first) != names.end()) << machine.first;
  }
}

class ExampleMachine : public testing::TestWithParam<std::string> {};

TEST_P(ExampleMachine, IsReadWithoutProblemsAndDrawn) {
  const Machine machine = read_example(GetParam());
  for (const MachineProblem& problem : find_problems(machine)) ADD_FAILURE() << problem.text();
  EXPECT_NE(draw_machine(machine).find(machine.chain()), std::string::npos);
  EXPECT_FALSE(machine.description.empty());
  const Machine again = parse_machine(machine_text(machine), "again");
  for (std::size_t i = 0; i < machine.axes.size(); ++i) EXPECT_EQ(again.axes[i].setting, machine.axes[i].setting);
}

/// The kinematics of these machines are compared with published numbers; the files must say the same.
TEST_P(ExampleMachine, HasTheValuesThatTheKinematicsAreTestedWith) {
  const auto entry = machines_in_code().find(GetParam());
  if (entry == machines_in_code().end()) return;
  const Machine file = read_example(GetParam());
  const Machine& code = entry->second;
  EXPECT_EQ(file.chain(), code.chain());
  ASSERT_EQ(file.axes.size(), code.axes.size());
  for (std::size_t i = 0; i < code.axes.size(); ++i) {
    const Axis &a = file.axes[i], &b = code.axes[i];
    EXPECT_LE((a.direction - b.direction).norm(), 1e-15) << a.name;
    EXPECT_LE((a.point - b.point).norm(), 1e-12) << a.name;
    EXPECT_EQ(a.endless, b.endless) << a.name;
    EXPECT_EQ(a.setting, b.setting) << a.name;
    if (a.endless) continue;
    EXPECT_NEAR(a.travel_min, b.travel_min, 1e-12) << a.name;
    EXPECT_NEAR(a.travel_max, b.travel_max, 1e-12) << a.name;
  }
  EXPECT_LE((file.tool_reference - code.tool_reference).norm(), 1e-12);
  EXPECT_LE((file.tool_offset - code.tool_offset).norm(), 1e-12);
  EXPECT_LE((file.tool_direction - code.tool_direction).norm(), 1e-15);
  EXPECT_LE((file.bed_from_workpiece.translation - code.bed_from_workpiece.translation).norm(), 1e-12);
  EXPECT_LE((file.bed_from_workpiece.rotation - code.bed_from_workpiece.rotation).norm(), 1e-15);
}

TEST_P(ExampleMachine, InverseAfterForwardGivesTheCommandsBack) {
  const Machine machine = read_example(GetParam());
  std::mt19937_64 generator(11);
  for (int i = 0; i < 200; ++i) {
    const std::vector<double> commands = test::random_commands(machine, generator);
    InverseOptions options;
    options.reference = commands;
    const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
    const InverseResult result = InverseKinematics(machine, options).solve(PoseTarget::at(pose), commands);
    ASSERT_EQ(result.status, InverseStatus::solved) << describe(machine, result);
    double nearest = 1e300;
    for (const InverseSolution& solution : result.solutions) {
      if (solution.singular_margin < 1e-3 || solution.linear_volume < 1e-3) nearest = 0;
      double largest = 0;
      for (std::size_t k = 0; k < commands.size(); ++k) {
        largest = std::max(largest, std::abs(solution.position[k] - commands[k]));
      }
      nearest = std::min(nearest, largest);
    }
    EXPECT_LE(nearest, 1e-7) << "pose " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(All, ExampleMachine, testing::ValuesIn(example_names()), [](const auto& machine_info) {
  std::string name = machine_info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace abbe
