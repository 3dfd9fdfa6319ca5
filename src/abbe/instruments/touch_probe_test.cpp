#include "abbe/instruments/touch_probe.h"

#include <Eigen/Geometry>

#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/meeting_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

const Eigen::Vector3d kTip(0.03, 0.01, -130);
const Eigen::Vector3d kAngles(0.01, -0.02, 0.4);

/// A ball plate of three spheres in two placements; its origin is where the tip stands at mid-travel.
TouchProbeSetup ball_plate(const Machine& machine, TouchProbeSetup::Measure measure, TouchProbeSetup::Frame frame) {
  TouchProbeSetup setup;
  setup.name = "probe";
  setup.measure = measure;
  setup.frame = frame;
  setup.tip = SetupPoint::within(kTip, 0.01);
  setup.tip_radius = SetupNumber::within(2.996, 1e-3);
  setup.spheres = {{"a", SetupPoint::exact({0, 0, 0}), SetupNumber::exact(10)},
                   {"b", SetupPoint::within({60, 2, 0}, 1e-3), SetupNumber::within(10.001, 1e-3)},
                   {"c", SetupPoint::open({-10, 45, 15}), SetupNumber::within(12.5, 1e-3)}};
  const Eigen::Vector3d at = test::seen_from_workpiece(machine, ErrorSet{}, test::middle(machine), kTip);
  setup.placements = {{"first", SetupPoint::open(at), SetupPoint::open(kAngles)},
                      {"second", SetupPoint::open(at + Eigen::Vector3d(20, 0, 5)), SetupPoint::open({0, 0, -1})}};
  setup.scale = SetupNumber::within(12e-6, 1e-6);
  return setup;
}

Eigen::Matrix3d turned(const Eigen::Vector3d& angles) {
  return (Eigen::AngleAxisd(angles[2], Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(angles[1], Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(angles[0], Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

/// Centre of the sphere of an item, independent of the instrument.
Eigen::Vector3d sphere_of(const TouchProbeSetup& setup, std::size_t item) {
  const TouchProbeSetup::Placement& placement = setup.placements[item / 3];
  return placement.position.value() +
         turned(placement.angles.value()) * setup.spheres[item % 3].centre.value() * (1 + setup.scale.value);
}

TEST(TouchProbe, ReportsWhereTheSphereIsFromTheCommand) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  for (const TouchProbeSetup::Frame frame : {TouchProbeSetup::Frame::probe, TouchProbeSetup::Frame::artefact}) {
    const TouchProbeSetup setup = ball_plate(machine, TouchProbeSetup::Measure::centre, frame);
    const auto probe = std::make_shared<TouchProbe>(setup);
    const InstrumentReadings plan = test::meeting_plan(machine, *probe, 0, 0.5, 5);
    ASSERT_EQ(probe->items().size(), 6u);
    EXPECT_EQ(probe->items()[4].name, "second/b");
    const InstrumentReadings readings = test::exact_readings(machine, errors, probe, plan);
    for (std::size_t k = 0; k < readings.count(); ++k) {
      const RigidTransform tool = actual_workpiece_from_tool(machine, errors, plan.poses.pose(k));
      const Eigen::Vector3d sphere = sphere_of(setup, plan.item[k]);
      Eigen::Vector3d expected = tool.inverse() * sphere + machine.tool_offset - kTip;
      if (frame == TouchProbeSetup::Frame::artefact) {
        expected = sphere - tool * Eigen::Vector3d(kTip - machine.tool_offset);
      }
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(readings.measured[static_cast<std::size_t>(i)][k], expected[i], 1e-9);
      }
      EXPECT_LT(expected.norm(), 1) << "nominal commands bring the tip near the sphere";
      EXPECT_GT(expected.norm(), 1e-3);
    }
  }
}

TEST(TouchProbe, FindsAShiftedSphereInTheDirectionsOfTheMachine) {
  // The table turned by 90 degrees: a sphere that lies off by workpiece x is found off by machine y.
  Machine machine = test::trunnion_mill();
  TouchProbeSetup setup;
  setup.tip = SetupPoint::exact({0, 0, -150});
  setup.spheres = {{"ball", SetupPoint::exact({80, 0, 60}), SetupNumber::exact(10)}};
  InstrumentReadings plan;
  std::vector<double> start(machine.axes.size(), 0.0);
  start[machine.find_axis("C")] = -std::acos(0.0);  // primed: the table turns by +90 degrees
  plan.append(*meet(machine, start, Body::tool, Body::workpiece, {{0, 0, -150}, {80, 0, 60}}, {0, 0, 0}), 0);
  setup.spheres[0].centre = SetupPoint::exact({80.01, 0, 60});
  const auto probe = std::make_shared<TouchProbe>(setup);
  const InstrumentReadings readings = test::exact_readings(machine, ErrorSet{}, probe, plan);
  EXPECT_NEAR(readings.measured[0][0], 0, 1e-9);
  EXPECT_NEAR(readings.measured[1][0], 0.01, 1e-9);
  EXPECT_NEAR(readings.measured[2][0], 0, 1e-9);
}

TEST(TouchProbe, TravelsAlongTheApproachUntilTheBallsTouch) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  const Eigen::Vector3d approach(2, -1, -2);
  for (const TouchProbeSetup::Frame frame : {TouchProbeSetup::Frame::probe, TouchProbeSetup::Frame::artefact}) {
    const TouchProbeSetup setup = ball_plate(machine, TouchProbeSetup::Measure::touch, frame);
    const auto probe = std::make_shared<TouchProbe>(setup);
    const InstrumentReadings plan =
        test::meeting_plan(machine, *probe, 3, 0.5, 5, {approach[0], approach[1], approach[2]});
    const InstrumentReadings readings = test::exact_readings(machine, errors, probe, plan);
    for (std::size_t k = 0; k < readings.count(); ++k) {
      const RigidTransform tool = actual_workpiece_from_tool(machine, errors, plan.poses.pose(k));
      const Eigen::Vector3d start = tool * Eigen::Vector3d(kTip - machine.tool_offset);
      const Eigen::Vector3d along =
          frame == TouchProbeSetup::Frame::probe ? Eigen::Vector3d(tool.rotation * approach) : approach;
      const Eigen::Vector3d touched = start + readings.measured[0][k] * along.normalized();
      const Eigen::Vector3d from_sphere = touched - sphere_of(setup, plan.item[k]);
      const double radii = setup.spheres[plan.item[k] % 3].radius.value + 2.996;
      EXPECT_NEAR(from_sphere.norm(), radii, 1e-9);
      EXPECT_LT(from_sphere.dot(along), 0) << "touched from the side it comes from";
    }
  }
}

TEST(TouchProbe, DerivativesEqualDifferences) {
  // Balls of some 10 mm bend within the differences' steps of up to 40 um.
  for (const Machine& machine : {test::trunnion_mill(), test::head_table_mill(), test::gantry_fork_head()}) {
    for (const TouchProbeSetup::Measure measure : {TouchProbeSetup::Measure::centre, TouchProbeSetup::Measure::touch}) {
      for (const TouchProbeSetup::Frame frame : {TouchProbeSetup::Frame::probe, TouchProbeSetup::Frame::artefact}) {
        const auto probe = std::make_shared<TouchProbe>(ball_plate(machine, measure, frame));
        std::vector<double> inputs;
        if (measure == TouchProbeSetup::Measure::touch) inputs = {1, 2, -2};
        test::expect_jacobian_equals_differences(machine, test::some_errors(machine), probe,
                                                 test::meeting_plan(machine, *probe, 3, 0.3, 6, inputs), 5e-6);
      }
    }
  }
}

TEST(TouchProbe, OnlyTheSumOfTheRadiiCounts) {
  const Machine machine = test::trunnion_mill();
  TouchProbeSetup setup = ball_plate(machine, TouchProbeSetup::Measure::touch, TouchProbeSetup::Frame::probe);
  const auto a = std::make_shared<TouchProbe>(setup);
  for (TouchProbeSetup::Sphere& sphere : setup.spheres) sphere.radius.value += 0.004;
  setup.tip_radius.value -= 0.004;
  const auto b = std::make_shared<TouchProbe>(setup);
  const InstrumentReadings plan = test::meeting_plan(machine, *a, 3, 0.5, 3, {0, 0, -1});
  const InstrumentReadings of_a = test::exact_readings(machine, ErrorSet{}, a, plan);
  const InstrumentReadings of_b = test::exact_readings(machine, ErrorSet{}, b, plan);
  for (std::size_t k = 0; k < plan.count(); ++k) EXPECT_NEAR(of_a.measured[0][k], of_b.measured[0][k], 1e-10);
}

TEST(TouchProbe, HasNoReadingWhereTheApproachMissesTheSphere) {
  const Machine machine = test::trunnion_mill();
  const TouchProbeSetup setup = ball_plate(machine, TouchProbeSetup::Measure::touch, TouchProbeSetup::Frame::probe);
  const auto probe = std::make_shared<TouchProbe>(setup);
  InstrumentReadings plan;
  plan.append(*meet(machine, test::middle(machine), Body::tool, Body::workpiece, *probe->meeting_points(0), {0, 0, 30}),
              0, {1, 0, 0});
  EXPECT_TRUE(std::isnan(test::exact_readings(machine, ErrorSet{}, probe, plan).measured[0][0]));
}

TEST(TouchProbe, RefusesASetupThatIsNone) {
  TouchProbeSetup bad;
  EXPECT_THROW(TouchProbe{bad}, std::invalid_argument);
  bad.spheres.resize(1);
  bad.spheres[0].radius = SetupNumber::exact(0);
  EXPECT_THROW(TouchProbe{bad}, std::invalid_argument);
}

}  // namespace
}  // namespace abbe
