#include "abbe/runtime/abbe_runtime.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "abbe/compensate/one_pose_for_test.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/machine/inverse_kinematics.h"
#include "abbe/runtime/frozen_for_test.h"

namespace abbe {
namespace {

/// Tolerances below those of the comparison.
CorrectionOptions tight() {
  CorrectionOptions options;
  options.position_tolerance = 5e-11;
  options.orientation_tolerance = 3e-13;
  return options;
}

double missed_direction(const Machine& machine, const RigidTransform& a, const RigidTransform& b) {
  const Eigen::Vector3d one = a.rotation * machine.tool_direction, other = b.rotation * machine.tool_direction;
  return std::atan2(one.cross(other).norm(), one.dot(other));
}

/// Length that coordinates of the machine may have, mm: rounding grows with it.
double size_of(const Machine& machine) {
  double size = machine.tool_reference.norm();
  for (const Axis& axis : machine.axes) {
    if (axis.kind == AxisKind::linear) size += std::max(std::abs(axis.travel_min), std::abs(axis.travel_max));
  }
  return size;
}

TEST(Runtime, CorrectsCommandsOfEveryMachineAsTheLibraryDoes) {
  for (const test::NamedMachine& named : test::all_machines()) {
    SCOPED_TRACE(named.name);
    const Machine& machine = named.machine;
    const ErrorSet errors = test::tens_of_micrometres(machine, 3);
    const test::RuntimePointer runtime = test::runtime_of(machine, errors);
    const CompensatedInverse library(machine, errors, tight());
    std::mt19937_64 generator(7);
    int compared = 0;
    for (int k = 0; k < 200; ++k) {
      const std::vector<double> nominal = test::inner_commands(machine, generator);
      std::vector<double> joints(nominal);
      int result = abbe_runtime_correct(runtime.get(), nullptr, nominal.data(), nullptr, 1, joints.data());
      CorrectionStatus status = CorrectionStatus::not_run;
      const std::vector<double> expected = test::corrected(library, nominal, status);
      if (status != CorrectionStatus::reached) continue;
      const RigidTransform wanted = nominal_workpiece_from_tool(machine, nominal);
      const RigidTransform there = actual_workpiece_from_tool(machine, errors, joints);
      result &= ~ABBE_OUTSIDE_TOOL;
      if (result == ABBE_TURN_LIMITED) {
        // Where the bound of turns begins depends on the derivative, which here is that of the nominal machine.
        const RigidTransform before = actual_workpiece_from_tool(machine, errors, nominal);
        EXPECT_LE(missed_direction(machine, there, wanted), 0.1 * missed_direction(machine, before, wanted));
        continue;
      }
      ASSERT_EQ(result, ABBE_OK) << abbe_runtime_text(result) << " " << k;
      ++compared;
      EXPECT_LE((there.translation - wanted.translation).norm(), 1e-15 * size_of(machine) + 1e-12) << k;
      if (machine.axes.size() < 5) continue;
      for (std::size_t i = 0; i < joints.size(); ++i) {
        const bool rotary = machine.axes[i].kind == AxisKind::rotary;
        // Near singularities a command is known as well as the pose divided by the small singular value.
        const double turn = std::max(1.0, 0.1 * std::abs(expected[i] - nominal[i]) / 1e-4);
        EXPECT_NEAR(joints[i], expected[i], rotary ? 1e-11 * turn : 1e-9 * turn) << k << " " << machine.axes[i].name;
      }
    }
    RecordProperty(named.name, compared);
    EXPECT_GE(compared, machine.axes.size() >= 5 ? 100 : 0);
  }
}

TEST(Runtime, FiveAxesBringTheActualToolToPointAndDirection) {
  for (const Machine& machine :
       {test::trunnion_mill(), test::head_table_mill(), test::gantry_fork_head(), test::nutating_head_mill()}) {
    SCOPED_TRACE(machine.name);
    const ErrorSet errors = test::tens_of_micrometres(machine, 11);
    const test::RuntimePointer runtime = test::runtime_of(machine, errors);
    std::mt19937_64 generator(13);
    int reached = 0;
    for (int k = 0; k < 500; ++k) {
      const std::vector<double> nominal = test::inner_commands(machine, generator);
      const RigidTransform wanted = nominal_workpiece_from_tool(machine, nominal);
      std::vector<double> joints(nominal);
      const int result = abbe_runtime_inverse(runtime.get(), nullptr, wanted.translation.data(), nominal.data(),
                                              machine.tool_offset.data(), 1, joints.data());
      ASSERT_GE(result, 0) << abbe_runtime_text(result);
      const RigidTransform there = actual_workpiece_from_tool(machine, errors, joints);
      EXPECT_LE((there.translation - wanted.translation).norm(), 1e-12 + 5e-16 * size_of(machine));
      if (result != ABBE_OK) continue;
      ++reached;
      EXPECT_LE(missed_direction(machine, there, wanted), 1e-14);
    }
    EXPECT_GE(reached, 450);
  }
}

TEST(Runtime, NominalCallsAreTheKinematicsOfTheMachine) {
  for (const test::NamedMachine& named : test::all_machines()) {
    SCOPED_TRACE(named.name);
    const Machine& machine = named.machine;
    const test::RuntimePointer runtime = test::runtime_of(machine, {});
    abbe_runtime_information about;
    abbe_runtime_describe(runtime.get(), &about);
    std::mt19937_64 generator(17);
    for (int k = 0; k < 50; ++k) {
      const std::vector<double> commands = test::random_commands(machine, generator);
      const RigidTransform pose = nominal_workpiece_from_tool(machine, commands);
      Eigen::Vector3d point;
      std::vector<double> words(commands.size()), joints(commands.size());
      const int result =
          abbe_runtime_nominal_forward(runtime.get(), commands.data(), nullptr, point.data(), words.data());
      if (about.tool_centre == 0) {
        EXPECT_EQ(result, ABBE_NOT_POSSIBLE);
        EXPECT_EQ(
            abbe_runtime_nominal_inverse(runtime.get(), pose.translation.data(), words.data(), nullptr, joints.data()),
            ABBE_NOT_POSSIBLE);
        continue;
      }
      ASSERT_EQ(result, ABBE_OK) << abbe_runtime_text(result);
      EXPECT_LE((point - pose.translation).norm(), 2e-12);
      EXPECT_EQ(words, commands);
      InverseOptions options;
      for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        abbe_runtime_axis axis;
        ASSERT_EQ(abbe_runtime_describe_axis(runtime.get(), static_cast<int>(i), &axis), ABBE_OK);
        EXPECT_EQ(axis.letter, machine.axes[i].name[0]);
        if (axis.solved == 0) options.held.push_back({i, commands[i]});
      }
      const InverseResult expected = InverseKinematics(machine, options).solve(PoseTarget::at(pose.translation));
      ASSERT_FALSE(expected.solutions.empty());
      if (expected.solutions[0].linear_volume < 0.02) continue;
      ASSERT_GE(abbe_runtime_nominal_inverse(runtime.get(), point.data(), words.data(), nullptr, joints.data()), 0);
      for (std::size_t i = 0; i < joints.size(); ++i)
        EXPECT_NEAR(joints[i], expected.solutions[0].position[i], 1e-9) << machine.axes[i].name;
    }
  }
}

/// Forward after inverse and inverse after forward, with and without state, at any part of the errors.
TEST(Runtime, ForwardAndInverseAreInverseToEachOther) {
  for (const Machine& machine : {test::trunnion_mill(), test::head_table_mill(), test::three_axis_mill(),
                                 test::nutating_head_mill(), test::swivel_head_mill()}) {
    SCOPED_TRACE(machine.name);
    const test::RuntimePointer runtime = test::runtime_of(machine, test::tens_of_micrometres(machine, 19));
    abbe_runtime_state state;
    abbe_runtime_start(&state);
    std::mt19937_64 generator(23);
    for (int k = 0; k < 400; ++k) {
      const std::vector<double> nominal = test::inner_commands(machine, generator);
      const Eigen::Vector3d point = nominal_workpiece_from_tool(machine, nominal).translation;
      const double enable = k % 4 == 0 ? 0.37 : 1;
      abbe_runtime_state* const used = k % 3 == 0 ? nullptr : &state;
      std::vector<double> joints(nominal.size()), words(nominal.size()), again(nominal.size());
      Eigen::Vector3d back;
      const int there =
          abbe_runtime_inverse(runtime.get(), used, point.data(), nominal.data(), nullptr, enable, joints.data());
      ASSERT_GE(there, 0);
      const int result =
          abbe_runtime_forward(runtime.get(), used, joints.data(), nullptr, enable, back.data(), words.data());
      ASSERT_EQ(result & ABBE_RESULT_MASK, there & ABBE_RESULT_MASK) << k;
      EXPECT_LE((back - point).norm(), 1e-12) << k;
      ASSERT_GE(abbe_runtime_inverse(runtime.get(), used, back.data(), words.data(), nullptr, enable, again.data()), 0);
      for (std::size_t i = 0; i < nominal.size(); ++i) {
        const bool rotary = machine.axes[i].kind == AxisKind::rotary;
        if (rotary && (there & ABBE_RESULT_MASK) == ABBE_OK) {
          EXPECT_NEAR(words[i], nominal[i], 1e-12) << k << " " << machine.axes[i].name;
        }
        EXPECT_NEAR(again[i], joints[i], 5e-12) << k << " " << machine.axes[i].name;
      }
    }
  }
}

}  // namespace
}  // namespace abbe
