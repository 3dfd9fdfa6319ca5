#include "abbe/compensate/point_correction.h"

#include <gtest/gtest.h>

#include "abbe/compensate/tables/error_tables.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

/// EZZ of the mill's spindle carrier over the whole travel of Z: `at_end` at the lower end, `slope` from there.
ErrorSet scale_of_z(const Machine& machine, double at_end, double slope) {
  const std::size_t z = machine.find_axis("Z");
  const double from = machine.axes[z].travel_min, to = machine.axes[z].travel_max;
  ErrorTables tables;
  tables.tables.push_back({z, {from, to}, {Component::Z}, {{at_end, at_end + slope * (to - from)}}});
  return errors_of(tables);
}

double correction_of_z(const Machine& machine, const ErrorSet& errors, double command) {
  const std::size_t z = machine.find_axis("Z");
  std::vector<double> pose(machine.axes.size(), 0.0);
  for (std::size_t i = 0; i < pose.size(); ++i) {
    pose[i] = (machine.axes[i].travel_min + machine.axes[i].travel_max) / 2;
  }
  pose[z] = command;
  PoseList commands, correction;
  commands.append(pose);
  PointCorrection(machine, errors).evaluate(commands, correction);
  return correction.axis[z][0];
}

// docs/controller-tables.md, beckhoff-isg: c + e(q + c) = 0, and not c + e(q) = 0.
TEST(PointCorrection, ErrorsAreThoseWhereTheCorrectedAxisStands) {
  const Machine machine = test::three_axis_mill();
  ASSERT_FALSE(machine.axes[machine.find_axis("Z")].primed);
  const double from = machine.axes[machine.find_axis("Z")].travel_min, slope = 2e-3;
  const ErrorSet errors = scale_of_z(machine, 0.1, slope);
  const double error = 0.1 + slope * 30;
  EXPECT_NEAR(correction_of_z(machine, errors, from + 30), -error / (1 + slope), 1e-11);
}

// The same beyond the last node, where a correction at the end of the travel leads: the last straight line goes on.
TEST(PointCorrection, BeyondTheLastNodeTheStraightLineGoesOn) {
  const Machine machine = test::three_axis_mill();
  const double from = machine.axes[machine.find_axis("Z")].travel_min, slope = 2e-3;
  const double correction = correction_of_z(machine, scale_of_z(machine, 0.1, slope), from);
  EXPECT_LT(from + correction, from);
  EXPECT_NEAR(correction, -0.1 / (1 + slope), 1e-11);
}

}  // namespace
}  // namespace abbe
