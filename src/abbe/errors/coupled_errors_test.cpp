#include <gtest/gtest.h>

#include <array>
#include <random>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/pose_model.h"
#include "abbe/errors/random_errors.h"
#include "abbe/machine/coupling.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

/// The same axes with commands that act independently: what a coupled machine does at commands this one does at the
/// positions.
Machine independent(Machine machine) {
  machine.couplings.clear();
  return machine;
}

struct CoupledCase {
  Machine machine;
  ErrorSet errors;
};

/// Error motions and location errors of every kind, some with the position of another axis or torques as states.
std::vector<CoupledCase> coupled_cases() {
  std::vector<CoupledCase> cases;
  for (Machine machine : {test::coupled_arm(), test::coupled_seven_axis_arm(), test::coupled_fork_head()}) {
    RandomErrorOptions options;
    options.seed = 9;
    options.constant_terms = true;
    ErrorSet errors = random_errors(machine, options);
    errors.tool_offset_error = {0.02, -0.03, 0.01};
    const std::size_t last = machine.axes.size() - 1, coupled = machine.couplings.front().axis;
    MachineState position{.name = "position", .kind = StateKind::axis};
    position.reference = 0.1;
    position.axis = coupled;
    MachineState torque{.name = "torque", .kind = StateKind::gravity};
    torque.axis = last - 1;
    torque.loads = {{last, 8, machine.tool_reference}};
    MachineState both{.name = "both", .kind = StateKind::product};
    both.first = 0;
    both.second = 1;
    machine.states = {position, torque, both};
    for (const std::size_t state : {std::size_t{0}, std::size_t{1}, std::size_t{2}}) {
      ErrorMotion motion = errors.motions[6 * last + 3 + state];
      motion.state = state;
      errors.motions.push_back(motion);
    }
    errors.locations.push_back({.axis = last - 1, .component = Component::X, .value = 2e-5, .state = 1});
    cases.push_back({machine, errors});
  }
  return cases;
}

TEST(CoupledErrors, AreThoseOfTheAxesAtTheirPositions) {
  for (const CoupledCase& c : coupled_cases()) {
    SCOPED_TRACE(c.machine.name);
    const Machine free = independent(c.machine);
    std::mt19937_64 generator(3);
    for (int k = 0; k < 20; ++k) {
      const std::vector<double> commands = test::random_commands(c.machine, generator);
      const std::vector<double> positions = positions_of_commands(c.machine, commands);
      const RigidTransform a = actual_workpiece_from_tool(c.machine, c.errors, commands);
      const RigidTransform b = actual_workpiece_from_tool(free, c.errors, positions);
      EXPECT_EQ(a.translation, b.translation);
      EXPECT_EQ(a.rotation, b.rotation);
      Deviation of_coupled, of_free;
      Eigen::MatrixXd by_coupled, by_free;
      EXPECT_EQ(tool_deviation(c.machine, c.errors, commands, of_coupled, &by_coupled),
                tool_deviation(free, c.errors, positions, of_free, &by_free));
      EXPECT_EQ(of_coupled, of_free);
      EXPECT_EQ(by_coupled, by_free);
      EXPECT_TRUE(covers_commands(c.machine, c.errors, commands));
    }
  }
}

TEST(CoupledErrors, BatchesAgreeWithSinglePoses) {
  for (const CoupledCase& c : coupled_cases()) {
    SCOPED_TRACE(c.machine.name);
    const std::size_t axes = c.machine.axes.size(), count = 2 * ChainPlan::kBlockSize + 5;
    const std::size_t parameters = c.errors.parameter_count();
    std::mt19937_64 generator(5);
    std::vector<std::vector<double>> commands(axes, std::vector<double>(count));
    for (std::size_t k = 0; k < count; ++k) {
      const std::vector<double> pose = test::random_commands(c.machine, generator);
      for (std::size_t i = 0; i < axes; ++i) commands[i][k] = pose[i];
    }
    std::vector<const double*> pointers;
    for (const std::vector<double>& values : commands) pointers.push_back(values.data());
    const PoseModel model(c.machine, c.errors);
    std::array<std::vector<double>, 6> deviation;
    std::array<double*, 6> deviations{};
    for (std::size_t r = 0; r < 6; ++r) {
      deviation[r].resize(count);
      deviations[r] = deviation[r].data();
    }
    std::vector<std::uint8_t> covered(count);
    std::vector<double> by_parameter(count * 6 * parameters), by_command(count * 6 * axes);
    const PositionArrays positions{pointers, count};
    model.deviations(positions, deviations.data(), covered.data());
    model.jacobian(positions, by_parameter.data());
    model.jacobian_by_positions(positions, by_command.data());
    for (std::size_t k = 0; k < count; k += 17) {
      std::vector<double> pose(axes);
      for (std::size_t i = 0; i < axes; ++i) pose[i] = commands[i][k];
      Deviation expected;
      Eigen::MatrixXd parameter_slopes, command_slopes;
      ASSERT_EQ(tool_deviation(c.machine, c.errors, pose, expected, &parameter_slopes, &command_slopes),
                PoseStatus::ok);
      EXPECT_EQ(covered[k], 1);
      for (std::size_t r = 0; r < 6; ++r) {
        const auto row = static_cast<Eigen::Index>(r);
        EXPECT_NEAR(deviation[r][k], expected[row], 1e-9);
        for (std::size_t p = 0; p < parameters; ++p) {
          const double slope = parameter_slopes(row, static_cast<Eigen::Index>(p));
          EXPECT_NEAR(by_parameter[(k * 6 + r) * parameters + p], slope, 1e-9 * (1 + std::abs(slope)));
        }
        for (std::size_t i = 0; i < axes; ++i) {
          const double slope = command_slopes(row, static_cast<Eigen::Index>(i));
          EXPECT_NEAR(by_command[(k * 6 + r) * axes + i], slope, 1e-9 * (1 + std::abs(slope)));
        }
      }
    }
  }
}

TEST(CoupledErrors, DerivativesByCommandsAreDifferenceQuotients) {
  for (const CoupledCase& c : coupled_cases()) {
    SCOPED_TRACE(c.machine.name);
    std::mt19937_64 generator(7);
    for (int k = 0; k < 10; ++k) {
      std::vector<double> commands = test::random_commands(c.machine, generator);
      for (double& command : commands) command *= 0.9;
      Deviation deviation;
      Eigen::MatrixXd slopes;
      tool_deviation(c.machine, c.errors, commands, deviation, nullptr, &slopes);
      for (std::size_t i = 0; i < commands.size(); ++i) {
        const double step = c.machine.axes[i].kind == AxisKind::rotary ? 1e-5 : 1e-2;
        std::vector<double> before = commands, after = commands;
        before[i] -= step;
        after[i] += step;
        const RigidTransform a = actual_workpiece_from_tool(c.machine, c.errors, before);
        const RigidTransform b = actual_workpiece_from_tool(c.machine, c.errors, after);
        const Eigen::Vector3d slope = (b.translation - a.translation) / (2 * step);
        const auto column = slopes.col(static_cast<Eigen::Index>(i)).head<3>();
        EXPECT_LE((slope - column).norm(), 2e-7 * (1 + slope.norm())) << c.machine.axes[i].name;
      }
    }
  }
}

TEST(CoupledErrors, FactorsOfStatesAreThoseOfPositions) {
  for (const CoupledCase& c : coupled_cases()) {
    const Machine free = independent(c.machine);
    std::mt19937_64 generator(11);
    std::vector<double> commands = test::random_commands(c.machine, generator);
    const std::vector<double> positions = positions_of_commands(c.machine, commands);
    for (std::size_t state = 0; state < 3; ++state) {
      std::vector<double> slopes;
      const double factor = state_factor(c.machine, state, commands, {}, &slopes);
      EXPECT_EQ(factor, state_factor(free, state, positions, {}));
      for (std::size_t i = 0; i < commands.size(); ++i) {
        const double step = 1e-5, command = commands[i];
        commands[i] = command + step;
        const double after = state_factor(c.machine, state, commands, {});
        commands[i] = command - step;
        const double before = state_factor(c.machine, state, commands, {});
        commands[i] = command;
        EXPECT_NEAR((after - before) / (2 * step), slopes[i], 1e-6 * (1 + std::abs(slopes[i])));
      }
    }
  }
}

TEST(CoupledErrors, ARangeIsOneOfPositions) {
  const Machine machine = test::coupled_arm();
  const std::size_t b1 = machine.find_axis("B1"), b2 = machine.find_axis("B2");
  ErrorSet errors;
  ErrorMotion motion{
      .axis = b2, .component = Component::X, .basis = {}, .coefficients = {0.01}, .standard_uncertainty = {}};
  motion.basis = {.kind = BasisKind::legendre, .order = 0, .from = -0.5, .to = 0.5};
  errors.motions.push_back(motion);
  std::vector<double> commands(6, 0.0);
  commands[b1] = 1;
  commands[b2] = 0.9;  // the position is -0.1
  EXPECT_TRUE(covers_commands(machine, errors, commands));
  commands[b2] = 0.2;  // -0.8
  EXPECT_FALSE(covers_commands(machine, errors, commands));
  Deviation deviation;
  EXPECT_EQ(tool_deviation(machine, errors, commands, deviation), PoseStatus::out_of_range);
  const PoseList poses{{{0.}, {1.}, {0.2}, {0.}, {0.}, {0.}}};
  EXPECT_NEAR(positions_of_axis(machine, poses, b2)[0], -0.8, 1e-15);
}

}  // namespace
}  // namespace abbe
