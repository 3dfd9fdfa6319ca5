#include "abbe/compensate/tables/line_tables.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/compensate/point_correction.h"
#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_errors.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

ErrorSet errors_of(const Machine& machine, std::uint64_t seed) {
  RandomErrorOptions options;
  options.seed = seed;
  return random_errors(machine, options);
}

Eigen::Vector3d shift(const Machine& machine, const ErrorSet& errors, const std::vector<double>& commands,
                      const std::vector<double>& corrected) {
  return actual_workpiece_from_tool(machine, errors, corrected).translation -
         nominal_workpiece_from_tool(machine, commands).translation;
}

/// Commands corrected by tables, as a control does it.
std::vector<double> corrected(const std::vector<AxisTable>& tables, const std::vector<double>& commands) {
  PoseList in, added;
  in.append(commands);
  AxisTableCorrection(tables).evaluate(in, added);
  std::vector<double> result = commands;
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += added.axis[i][0];
  return result;
}

TEST(LineTables, PositioningErrorsOfPrimedAndUnprimedAxesAreTakenAway) {
  // The table of the mill carries the workpiece, so that its positive command moves the table the other way.
  const Machine machine = test::three_axis_mill();
  ASSERT_TRUE(machine.axes[machine.find_axis("X")].primed);
  ASSERT_FALSE(machine.axes[machine.find_axis("Z")].primed);
  RandomErrorOptions options;
  options.only = {"EXX", "EYY", "EZZ"};
  const ErrorSet errors = random_errors(machine, options);
  const std::vector<AxisTable> tables = line_tables(machine, errors, {}).tables;
  ASSERT_EQ(tables.size(), 3U);
  std::mt19937_64 generator(5);
  double before = 0;
  for (int k = 0; k < 100; ++k) {
    const std::vector<double> pose = test::random_commands(machine, generator);
    before = std::max(before, shift(machine, errors, pose, pose).norm());
    EXPECT_LT(shift(machine, errors, pose, corrected(tables, pose)).norm(), 2e-4);
  }
  EXPECT_GT(before, 0.01);
  // Positive direction: where the spindle goes too far up, the command is lowered.
  const AxisTable& z = tables[2];
  const double q = z.positions[3];
  EXPECT_NEAR(z.forward[3], -errors.evaluate(machine.find_axis("Z"), q)[2], 1e-5);
  EXPECT_GT(std::abs(z.forward[3]), 1e-3);
}

TEST(LineTables, OwnAndCrossTablesTakeTheShiftAwayOnTheLinesThroughTheReference) {
  for (const Machine& machine : {test::three_axis_mill(), test::moving_table_cmm(), test::trunnion_mill()}) {
    const ErrorSet errors = errors_of(machine, 11);
    LineTableOptions options;
    options.cross = true;
    options.reference = middle_of_travel(machine, errors);
    const std::vector<AxisTable> tables = line_tables(machine, errors, options).tables;
    const std::vector<double> reference = options.reference;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      const KnownTravel travel = known_travel(machine, errors, i);
      for (const double q : evenly_spaced(travel.from, travel.to, 23)) {
        std::vector<double> pose = reference;
        pose[i] = q;
        // Three axes are interpolated at most, and second order of the corrections is far below a tenth of a um.
        EXPECT_LT(shift(machine, errors, pose, corrected(tables, pose)).norm(), 3e-4)
            << machine.name << " " << machine.axes[i].name << " " << q;
      }
    }
  }
}

TEST(LineTables, ZeroPositionAndRotaryPositioningErrorsAreOwnCorrections) {
  const Machine machine = test::trunnion_mill();
  ErrorSet errors;
  const std::size_t a = machine.find_axis("A"), x = machine.find_axis("X");
  errors.locations.push_back({a, Component::A, 2e-4, 0});
  errors.locations.push_back({x, Component::X, 0.03, 0});
  // Displaced by their zero, both axes are where they should be one zero earlier.
  EXPECT_NEAR(own_correction(machine, errors, a, 0.3), -2e-4, 1e-12);
  EXPECT_NEAR(own_correction(machine, errors, x, 100), -0.03, 1e-12);
  ErrorMotion motion;
  motion.axis = a;
  motion.component = Component::A;
  motion.basis.kind = BasisKind::legendre;
  motion.basis.order = 0;
  motion.basis.from = machine.axes[a].travel_min;
  motion.basis.to = machine.axes[a].travel_max;
  motion.coefficients = {5e-5};
  errors.motions.push_back(motion);
  EXPECT_NEAR(own_correction(machine, errors, a, 0.3), -2e-4 - machine.axes[a].sense() * 5e-5, 1e-12);
  const double q = 0.3 + own_correction(machine, errors, a, 0.3);
  std::vector<double> pose(machine.axes.size(), 0.0), moved = pose;
  pose[a] = 0.3;
  moved[a] = q;
  moved[x] = own_correction(machine, errors, x, 0);
  EXPECT_LT(shift(machine, errors, pose, moved).norm(), 1e-9);
}

TEST(LineTables, AnEndlessAxisHasATableThatMeetsItself) {
  const Machine machine = test::trunnion_mill();
  RandomErrorOptions options;
  options.only = {"ECC"};
  const ErrorSet errors = random_errors(machine, options);
  const std::vector<AxisTable> tables = line_tables(machine, errors, {}).tables;
  ASSERT_FALSE(tables.empty());
  const AxisTable& table = tables.front();
  EXPECT_EQ(table.input, machine.find_axis("C"));
  EXPECT_TRUE(table.modulo);
  EXPECT_EQ(table.forward.front(), table.forward.back());
  EXPECT_NEAR(table.at(0.7), table.at(0.7 + 6.283185307179586), 1e-12);
  EXPECT_NEAR(table.at(-0.2), table.at(6.083185307179586), 1e-12);
}

TEST(LineTables, UncertaintyOfACorrectionIsThatOfTheErrorItTakesAway) {
  const Machine machine = test::three_axis_mill();
  ErrorSet errors;
  ErrorMotion motion;
  motion.axis = machine.find_axis("Z");
  motion.component = Component::Z;
  motion.basis.kind = BasisKind::legendre;
  motion.basis.order = 1;
  motion.basis.from = -460;
  motion.basis.to = 0;
  motion.coefficients = {0.001, 0.010};
  motion.standard_uncertainty = {0.0003, 0.0004};
  errors.motions.push_back(motion);
  const std::vector<double> reference = middle_of_travel(machine, errors);
  const std::vector<double> uncertainty =
      propagated_uncertainty(errors, stated_variances(errors), [&](const ErrorSet& changed) {
        return line_correction(machine, changed, reference, motion.axis, motion.axis, {-460, -230, 0}, false);
      });
  // P0 = 1 and P1 = -1, 0, 1.
  EXPECT_NEAR(uncertainty[0], 0.0005, 1e-7);
  EXPECT_NEAR(uncertainty[1], 0.0003, 1e-7);
  EXPECT_NEAR(uncertainty[2], 0.0005, 1e-7);
}

}  // namespace
}  // namespace abbe
