#include "abbe/instruments/autocollimator.h"

#include <Eigen/Geometry>

#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/meeting_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

AutocollimatorSetup along_x(AutocollimatorSetup::Indication indication) {
  AutocollimatorSetup setup;
  setup.name = "ac";
  setup.beam = {2, 0.01, 0};
  setup.first = {0.3, 1, 0};
  setup.mirror_tilt_first = SetupNumber::open(150e-6);
  setup.mirror_tilt_second = SetupNumber::open(-250e-6);
  setup.zero_first = SetupNumber::within(30e-6, 20e-6);
  setup.zero_second = SetupNumber::within(-10e-6, 20e-6);
  setup.indication = indication;
  return setup;
}

InstrumentReadings anywhere(const Machine& machine, std::size_t count, double turn = 0) {
  InstrumentReadings plan;
  std::vector<AxisRange> ranges = full_ranges(machine, 2);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    if (machine.axes[i].kind == AxisKind::rotary) ranges[i] = {0, turn, 2, 0};
  }
  const PoseList poses = random_plan(machine, ranges, count, 4);
  for (std::size_t k = 0; k < poses.count(); ++k) plan.append(poses.pose(k), 0);
  return plan;
}

TEST(Autocollimator, ShowsWhereTheMirrorSendsTheBeam) {
  using Indication = AutocollimatorSetup::Indication;
  const Machine machine = test::three_axis_mill();
  const ErrorSet errors = test::some_errors(machine);
  const InstrumentReadings plan = anywhere(machine, 15);
  for (const Indication indication : {Indication::mirror_angle, Indication::half_tangent}) {
    const AutocollimatorSetup setup = along_x(indication);
    const InstrumentReadings readings =
        test::exact_readings(machine, errors, std::make_shared<Autocollimator>(setup), plan);
    const Eigen::Vector3d beam = setup.beam.normalized();
    const Eigen::Vector3d second = beam.cross(setup.first).normalized(), first = second.cross(beam);
    const DirectionFrame mirror = DirectionFrame::of(-beam);
    const Eigen::Vector3d normal = mirror.direction + setup.mirror_tilt_first.value * mirror.first +
                                   setup.mirror_tilt_second.value * mirror.second;
    for (std::size_t k = 0; k < plan.count(); ++k) {
      const Eigen::Matrix3d table = actual_bed_from_workpiece(machine, errors, plan.poses.pose(k)).rotation;
      // Back through the pinhole: the beam's image at unit distance, turned by a half turn about the normal and
      // reversed.
      const Eigen::Vector3d back = Eigen::AngleAxisd(std::acos(-1.0), (table * normal).normalized()) * -beam;
      const double x = back.dot(first) / -back.dot(beam), y = back.dot(second) / -back.dot(beam);
      const bool tangent = indication == Indication::half_tangent;
      EXPECT_NEAR(readings.measured[0][k] - setup.zero_first.value, (tangent ? x : std::atan(x)) / 2, 1e-13);
      EXPECT_NEAR(readings.measured[1][k] - setup.zero_second.value, (tangent ? y : std::atan(y)) / 2, 1e-13);
    }
  }
}

TEST(Autocollimator, SignsAreThoseOfTheDocumentation) {
  using Indication = AutocollimatorSetup::Indication;
  const Machine head = test::head_table_mill();
  AutocollimatorSetup setup;  // beam along +X, first along +Y
  const auto read = [&](const char* axis, double angle, Body body) {
    setup.mirror_body = body;
    InstrumentReadings plan;
    std::vector<double> positions(head.axes.size(), 0.0);
    positions[head.find_axis(axis)] = angle;
    plan.append(positions, 0);
    return test::exact_readings(head, ErrorSet{}, std::make_shared<Autocollimator>(setup), plan);
  };
  InstrumentReadings readings = read("C", -0.02, Body::workpiece);  // primed: the table turns by +0.02 about Z
  EXPECT_NEAR(readings.measured[0][0], -0.02, 1e-12);
  EXPECT_NEAR(readings.measured[1][0], 0, 1e-12);
  readings = read("B", 0.02, Body::tool);
  EXPECT_NEAR(readings.measured[0][0], 0, 1e-12);
  EXPECT_NEAR(readings.measured[1][0], 0.02, 1e-12);
  setup.indication = Indication::half_tangent;
  readings = read("B", 0.02, Body::tool);
  EXPECT_NEAR(readings.measured[1][0], std::tan(0.04) / 2, 1e-12);
}

TEST(Autocollimator, DerivativesEqualDifferences) {
  using Indication = AutocollimatorSetup::Indication;
  for (const Indication indication : {Indication::mirror_angle, Indication::half_tangent}) {
    const auto collimator = std::make_shared<Autocollimator>(along_x(indication));
    for (const Machine& machine : {test::three_axis_mill(), test::moving_table_cmm(), test::trunnion_mill()}) {
      test::expect_jacobian_equals_differences(machine, test::some_errors(machine), collimator,
                                               anywhere(machine, 15, 0.02));
    }
  }
}

TEST(Autocollimator, DoesNotSeeRollAboutTheBeam) {
  const Machine machine = test::trunnion_mill();
  const auto collimator = std::make_shared<Autocollimator>(AutocollimatorSetup{});
  InstrumentReadings plan;
  std::vector<double> positions(machine.axes.size(), 0.0);
  positions[machine.find_axis("A")] = 0.3;
  plan.append(positions, 0);
  const InstrumentReadings readings = test::exact_readings(machine, ErrorSet{}, collimator, plan);
  EXPECT_NEAR(readings.measured[0][0], 0, 1e-12);
  EXPECT_NEAR(readings.measured[1][0], 0, 1e-12);
}

TEST(Autocollimator, RefusesABeamWithoutAcross) {
  AutocollimatorSetup bad;
  bad.first = bad.beam;
  EXPECT_THROW(Autocollimator{bad}, std::invalid_argument);
  bad.beam.setZero();
  EXPECT_THROW(Autocollimator{bad}, std::invalid_argument);
}

}  // namespace
}  // namespace abbe
