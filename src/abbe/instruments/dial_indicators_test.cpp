#include "abbe/instruments/dial_indicators.h"

#include <Eigen/Geometry>

#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/meeting_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

/// Four dials on the spindle carriage, two on a face that looks up and two on one that looks along -Y.
DialIndicatorsSetup four_dials() {
  DialIndicatorsSetup setup;
  setup.name = "carriage";
  DialIndicatorsSetup::Face top, side;
  top.name = "top";
  top.point = {100, 20, 50};
  top.offset = SetupNumber::open(0.2);
  top.tilt_first = SetupNumber::open(2e-3);
  top.tilt_second = SetupNumber::open(-1e-3);
  side.name = "side";
  side.point = {100, 60, 20};
  side.normal = {0, -2, 0.1};
  side.offset = SetupNumber::within(-0.1, 0.05);
  side.tilt_first = SetupNumber::within(1e-3, 1e-4);
  side.tilt_second = SetupNumber::open(3e-3);
  setup.faces = {top, side};
  const auto dial = [](const char* name, const Eigen::Vector3d& at, const Eigen::Vector3d& direction,
                       std::size_t face) {
    return DialIndicatorsSetup::Dial{name, SetupPoint::within(at, 0.5), direction, SetupNumber::open(0.01), face};
  };
  setup.arrangements = {{"four",
                         {dial("z1", {-50, 0, -120}, {0, 0, 1}, 0), dial("z2", {60, 5, -121}, {0.02, 0, 1}, 0),
                          dial("y1", {-50, 40, -140}, {0, -1, 0}, 1), dial("y2", {55, 41, -150}, {0, -3, 0.1}, 1)}}};
  return setup;
}

/// A face as three of its points, made by turning the nominal one: not through the normal's formula.
struct ThreePoints {
  Eigen::Vector3d a, b, c;
};
ThreePoints points_of(const DialIndicatorsSetup::Face& face) {
  const DirectionFrame frame = DirectionFrame::of(face.normal);
  const Eigen::Vector3d origin = face.point + face.offset.value * frame.direction;
  // A normal that leans towards `first` by its tangent makes the face fall towards `first` by the same.
  return {origin, origin + frame.first - face.tilt_first.value * frame.direction,
          origin + frame.second - face.tilt_second.value * frame.direction};
}

TEST(DialIndicators, TipsStandOnTheirFaces) {
  const Machine machine = test::three_axis_mill();
  const ErrorSet errors = test::some_errors(machine);
  const DialIndicatorsSetup setup = four_dials();
  const auto dials = std::make_shared<DialIndicators>(setup);
  const InstrumentReadings plan = test::anywhere(machine, 20);
  const InstrumentReadings readings = test::exact_readings(machine, errors, dials, plan);
  ASSERT_EQ(readings.measured.size(), 4u);
  for (std::size_t k = 0; k < readings.count(); ++k) {
    const RigidTransform tool = actual_workpiece_from_tool(machine, errors, plan.poses.pose(k));
    for (std::size_t i = 0; i < 4; ++i) {
      const DialIndicatorsSetup::Dial& dial = setup.arrangements[0].dials[i];
      const double pushed = readings.measured[i][k] - dial.zero.value;
      const Eigen::Vector3d tip =
          tool * Eigen::Vector3d(dial.position.value() + pushed * dial.direction.normalized() - machine.tool_offset);
      const ThreePoints face = points_of(setup.faces[dial.face]);
      const Eigen::Matrix3d sides = (Eigen::Matrix3d() << face.b - face.a, face.c - face.a, tip - face.a).finished();
      EXPECT_NEAR(sides.determinant(), 0, 1e-9) << "dial " << i << ", reading " << k;
    }
  }
}

TEST(DialIndicators, ReadMoreWhereTheFaceComesNearer) {
  const Machine machine = test::three_axis_mill();
  DialIndicatorsSetup setup = four_dials();
  const InstrumentReadings plan = test::anywhere(machine, 5);
  const auto before = std::make_shared<DialIndicators>(setup);
  for (DialIndicatorsSetup::Face& face : setup.faces) face.offset.value += 0.01;
  const auto after = std::make_shared<DialIndicators>(setup);
  const InstrumentReadings a = test::exact_readings(machine, ErrorSet{}, before, plan);
  const InstrumentReadings b = test::exact_readings(machine, ErrorSet{}, after, plan);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < plan.count(); ++k) EXPECT_NEAR(b.measured[i][k] - a.measured[i][k], 0.01, 1e-4);
  }
}

TEST(DialIndicators, DerivativesEqualDifferences) {
  for (const Machine& machine : {test::three_axis_mill(), test::moving_table_cmm()}) {
    const auto dials = std::make_shared<DialIndicators>(four_dials());
    test::expect_jacobian_equals_differences(machine, test::some_errors(machine), dials, test::anywhere(machine, 15));
  }
  // Turned heads and tables need plungers that still meet their faces.
  for (const Machine& machine : {test::trunnion_mill(), test::gantry_fork_head()}) {
    const auto dials = std::make_shared<DialIndicators>(four_dials());
    InstrumentReadings plan;
    std::vector<AxisRange> ranges = full_ranges(machine, 2);
    const std::vector<double> centre = test::middle(machine);
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      if (machine.axes[i].kind == AxisKind::rotary) ranges[i] = {centre[i] - 0.1, centre[i] + 0.1, 2, 0};
      if (machine.axes[i].endless) ranges[i] = {0, 0.2, 2, 0};
    }
    const PoseList poses = random_plan(machine, ranges, 15, 4);
    for (std::size_t k = 0; k < poses.count(); ++k) plan.append(poses.pose(k), 0);
    test::expect_jacobian_equals_differences(machine, test::some_errors(machine), dials, plan);
  }
}

TEST(DialIndicators, OneDialGoesOverTwoFacesInTwoArrangements) {
  const Machine machine = test::three_axis_mill();
  const ErrorSet errors = test::some_errors(machine);
  const DialIndicatorsSetup four = four_dials();
  DialIndicatorsSetup one = four;
  one.arrangements = {{"up", {four.arrangements[0].dials[0]}}, {"across", {four.arrangements[0].dials[2]}}};
  const auto all = std::make_shared<DialIndicators>(four);
  const auto single = std::make_shared<DialIndicators>(one);
  ASSERT_EQ(single->components().size(), 1u);
  InstrumentReadings plan = test::anywhere(machine, 6);
  const InstrumentReadings of_all = test::exact_readings(machine, errors, all, plan);
  for (std::size_t k = 0; k < plan.count(); ++k) plan.item[k] = k % 2;
  const InstrumentReadings of_one = test::exact_readings(machine, errors, single, plan);
  for (std::size_t k = 0; k < plan.count(); ++k) {
    EXPECT_NEAR(of_one.measured[0][k], of_all.measured[k % 2 == 0 ? 0 : 2][k], 1e-12);
  }
  test::expect_jacobian_equals_differences(machine, errors, single, plan);
}

TEST(DialIndicators, FlatnessAndReadingBothMakeNoise) {
  DialIndicatorsSetup setup = four_dials();
  setup.noise = 0.3e-3;
  setup.flatness = 0.4e-3;
  EXPECT_NEAR(DialIndicators(setup).standard_uncertainty({}, 0, 0), 0.5e-3, 1e-15);
}

TEST(DialIndicators, RefuseASetupThatIsNone) {
  DialIndicatorsSetup bad = four_dials();
  bad.faces.clear();
  EXPECT_THROW(DialIndicators{bad}, std::invalid_argument);
  bad = four_dials();
  bad.arrangements.clear();
  EXPECT_THROW(DialIndicators{bad}, std::invalid_argument);
  bad = four_dials();
  bad.arrangements.push_back({"three", {bad.arrangements[0].dials[0]}});
  EXPECT_THROW(DialIndicators{bad}, std::invalid_argument);
  bad = four_dials();
  bad.arrangements[0].dials[1].face = 2;
  EXPECT_THROW(DialIndicators{bad}, std::invalid_argument);
  bad = four_dials();
  bad.faces[0].normal.setZero();
  EXPECT_THROW(DialIndicators{bad}, std::invalid_argument);
}

}  // namespace
}  // namespace abbe
