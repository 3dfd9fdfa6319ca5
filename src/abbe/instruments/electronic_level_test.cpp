#include "abbe/instruments/electronic_level.h"

#include <Eigen/Geometry>
#include <numbers>

#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/meeting_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

ElectronicLevelSetup two_axes(bool relative) {
  ElectronicLevelSetup setup;
  setup.name = "level";
  setup.axes = {{"along_x", {1, 0.1, 0}, SetupNumber::open(20e-6)},
                {"along_y", {0, 2, 0.1}, SetupNumber::open(-30e-6)}};
  setup.relative = relative;
  setup.up_tilt_first = SetupNumber::within(80e-6, 50e-6);
  setup.up_tilt_second = SetupNumber::within(-40e-6, 50e-6);
  return setup;
}

TEST(ElectronicLevel, ReadsByHowMuchOneEndOfABarIsHigher) {
  const Machine machine = test::three_axis_mill();
  const ErrorSet errors = test::some_errors(machine);
  const InstrumentReadings plan = test::anywhere(machine, 15);
  for (const bool relative : {false, true}) {
    const ElectronicLevelSetup setup = two_axes(relative);
    const auto level = std::make_shared<ElectronicLevel>(setup);
    const InstrumentReadings readings = test::exact_readings(machine, errors, level, plan);
    // Heights above a horizontal plane through three points, in the frame of the bed.
    const Eigen::Vector3d along(1, 0, -setup.up_tilt_first.value), across(0, 1, -setup.up_tilt_second.value);
    const Eigen::Vector3d vertical = along.cross(across).normalized();
    for (std::size_t k = 0; k < plan.count(); ++k) {
      const RigidTransform table = actual_bed_from_workpiece(machine, errors, plan.poses.pose(k));
      for (std::size_t i = 0; i < 2; ++i) {
        const double length = 100;
        const Eigen::Vector3d bar = length * setup.axes[i].direction.normalized();
        const double rise = vertical.dot(table * bar - table * Eigen::Vector3d(0, 0, 0));
        double expected = std::asin(rise / length) + setup.axes[i].zero.value;
        if (relative) expected -= std::asin(vertical.dot(bar) / length);
        EXPECT_NEAR(readings.measured[i][k], expected, 1e-12);
      }
    }
  }
}

TEST(ElectronicLevel, ATableTurningAboutYLowersItsEndX) {
  const Machine machine = test::trunnion_mill();
  ElectronicLevelSetup setup;
  setup.axes = {{"x", {1, 0, 0}, {}}, {"y", {0, 1, 0}, {}}};
  const auto level = std::make_shared<ElectronicLevel>(setup);
  InstrumentReadings plan;
  std::vector<double> positions(machine.axes.size(), 0.0);
  positions[machine.find_axis("A")] = -0.01;  // primed: the table turns by +0.01 about X
  plan.append(positions, 0);
  InstrumentReadings readings = test::exact_readings(machine, ErrorSet{}, level, plan);
  EXPECT_NEAR(readings.measured[0][0], 0, 1e-12);
  EXPECT_NEAR(readings.measured[1][0], 0.01, 1e-12) << "+EA raises the end Y";

  const Machine head = test::head_table_mill();
  setup.body = Body::tool;
  positions.assign(head.axes.size(), 0.0);
  positions[head.find_axis("B")] = 0.01;
  plan = {};
  plan.append(positions, 0);
  readings = test::exact_readings(head, ErrorSet{}, std::make_shared<ElectronicLevel>(setup), plan);
  EXPECT_NEAR(readings.measured[0][0], -0.01, 1e-12) << "+EB lowers the end X";
  EXPECT_NEAR(readings.measured[1][0], 0, 1e-12);
}

TEST(ElectronicLevel, TurnedByHalfATurnShowsItsZero) {
  const Machine machine = test::trunnion_mill();
  ElectronicLevelSetup setup = two_axes(false);
  for (ElectronicLevelSetup::Axis& axis : setup.axes) axis.direction[2] = 0;
  const auto level = std::make_shared<ElectronicLevel>(setup);
  InstrumentReadings plan;
  std::vector<double> positions(machine.axes.size(), 0.0);
  plan.append(positions, 0);
  positions[machine.find_axis("C")] = std::numbers::pi;
  plan.append(positions, 0);
  const InstrumentReadings readings = test::exact_readings(machine, ErrorSet{}, level, plan);
  for (std::size_t i = 0; i < 2; ++i) {
    const std::vector<double>& m = readings.measured[i];
    EXPECT_NEAR((m[0] + m[1]) / 2, setup.axes[i].zero.value, 1e-12);
    EXPECT_GT(std::abs(m[0] - m[1]), 20e-6) << "the machine stands out of level";
  }
}

TEST(ElectronicLevel, DerivativesEqualDifferences) {
  for (const bool relative : {false, true}) {
    const auto level = std::make_shared<ElectronicLevel>(two_axes(relative));
    for (const Machine& machine : {test::three_axis_mill(), test::moving_table_cmm()}) {
      test::expect_jacobian_equals_differences(machine, test::some_errors(machine), level, test::anywhere(machine, 15));
    }
    ElectronicLevelSetup setup = two_axes(relative);
    setup.body = Body::tool;
    setup.reference_body = Body::workpiece;
    const auto on_head = std::make_shared<ElectronicLevel>(setup);
    for (const Machine& machine : {test::three_axis_mill(), test::moving_table_cmm()}) {
      test::expect_jacobian_equals_differences(machine, test::some_errors(machine), on_head,
                                               test::anywhere(machine, 15));
    }
  }
}

TEST(ElectronicLevel, DifferenceOfTwoLevelsOnMovingBodiesNeedsNoInclinationOfTheReference) {
  // The table's own inclination against the bed enters in products of small angles only.
  const Machine machine = test::three_axis_mill();
  const ErrorSet errors = test::some_errors(machine);
  ElectronicLevelSetup setup = two_axes(true);
  setup.body = Body::tool;
  setup.reference_body = Body::workpiece;
  const InstrumentReadings plan = test::anywhere(machine, 20);
  const InstrumentReadings readings =
      test::exact_readings(machine, errors, std::make_shared<ElectronicLevel>(setup), plan);
  const Eigen::Vector3d up = DirectionFrame::of(setup.up).tilted(setup.up_tilt_first.value, setup.up_tilt_second.value);
  for (std::size_t k = 0; k < plan.count(); ++k) {
    const std::vector<double> at = plan.poses.pose(k);
    const Eigen::Matrix3d head = actual_bed_from_tool(machine, errors, at).rotation;
    const Eigen::Matrix3d table = actual_bed_from_workpiece(machine, errors, at).rotation;
    for (std::size_t i = 0; i < 2; ++i) {
      const Eigen::Vector3d d = setup.axes[i].direction.normalized();
      const double exact = std::asin(up.dot(head * d)) - std::asin(up.dot(table * d)) + setup.axes[i].zero.value;
      EXPECT_NEAR(readings.measured[i][k], exact, 5e-8);
    }
  }
}

TEST(ElectronicLevel, RefusesAxesThatAreNone) {
  ElectronicLevelSetup bad;
  EXPECT_THROW(ElectronicLevel{bad}, std::invalid_argument);
  bad.axes.resize(3);
  EXPECT_THROW(ElectronicLevel{bad}, std::invalid_argument);
  bad.axes.resize(1);
  bad.axes[0].direction = {0, 0, 3};
  EXPECT_THROW(ElectronicLevel{bad}, std::invalid_argument);
}

}  // namespace
}  // namespace abbe
