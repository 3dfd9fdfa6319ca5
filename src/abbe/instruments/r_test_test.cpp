#include "abbe/instruments/r_test.h"

#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/meeting_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

const Eigen::Vector3d kSphere(0.02, -0.01, -140);

/// Three plungers inclined by 54.7 degrees to the vertical, as in a usual nest; the sphere meets it at mid-travel.
RTestSetup cosy_nest(const Machine& machine, RTestSetup::Tip tip) {
  RTestSetup setup;
  setup.name = "nest";
  setup.nest = SetupPoint::open(test::seen_from_workpiece(machine, ErrorSet{}, test::middle(machine), kSphere));
  setup.spheres = {{"ball", SetupPoint::within(kSphere, 0.01)}};
  const Eigen::Vector3d directions[] = {{1, 0.1, -0.7}, {-0.5, 0.8, -0.7}, {-0.4, -0.9, -0.8}};
  for (int i = 0; i < 3; ++i) {
    RTestSetup::Probe probe;
    probe.name = "p" + std::to_string(i + 1);
    probe.direction = directions[i];
    probe.tilt_first = SetupNumber::within(0.002 * i, 1e-3);
    probe.tilt_second = SetupNumber::within(-0.001, 1e-3);
    probe.zero = SetupNumber::open(0.1 * i);
    probe.tip = tip;
    if (tip == RTestSetup::Tip::ball) {
      probe.tip_radius = 1.5;
      probe.offset_first = SetupNumber::within(0.05, 0.05);
      probe.offset_second = SetupNumber::within(-0.03 * i, 0.05);
    }
    setup.probes.push_back(probe);
  }
  setup.sphere_radius = SetupNumber::within(11, 1e-3);
  return setup;
}

Eigen::Vector3d plunger(const RTestSetup::Probe& probe) {
  return DirectionFrame::of(probe.direction).tilted(probe.tilt_first.value, probe.tilt_second.value);
}

TEST(RTest, FlatTipIsATangentPlaneOfTheSphere) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  const RTestSetup setup = cosy_nest(machine, RTestSetup::Tip::flat);
  const auto nest = std::make_shared<RTest>(setup);
  const InstrumentReadings plan = test::meeting_plan(machine, *nest, 0.5, 0.6, 20);
  const InstrumentReadings readings = test::exact_readings(machine, errors, nest, plan);
  for (std::size_t k = 0; k < readings.count(); ++k) {
    const Eigen::Vector3d sphere = test::seen_from_workpiece(machine, errors, plan.poses.pose(k), kSphere);
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d d = plunger(setup.probes[i]);
      // The tip's face, which stands one radius behind the nest centre when the sphere is in it.
      const Eigen::Vector3d face = setup.nest.value() + (11 + readings.measured[i][k] - setup.probes[i].zero.value) * d;
      EXPECT_NEAR(d.dot(face - sphere), 11, 1e-9);
    }
  }
}

TEST(RTest, BallTipTouchesTheSphereFromOutside) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  const RTestSetup setup = cosy_nest(machine, RTestSetup::Tip::ball);
  const auto nest = std::make_shared<RTest>(setup);
  const InstrumentReadings plan = test::meeting_plan(machine, *nest, 0.5, 0.6, 20);
  const InstrumentReadings readings = test::exact_readings(machine, errors, nest, plan);
  const double radii = 11 + 1.5;
  for (std::size_t i = 0; i < 3; ++i) {
    const RTestSetup::Probe& probe = setup.probes[i];
    const DirectionFrame frame = DirectionFrame::of(probe.direction);
    const Eigen::Vector3d d = plunger(probe);
    const Eigen::Vector3d line =
        setup.nest.value() + probe.offset_first.value * frame.first + probe.offset_second.value * frame.second;
    // Place of the tip on its line, moved in from far outside until it touches: bisection, no formula.
    const auto touches = [&](const Eigen::Vector3d& sphere) {
      double outside = 2 * radii, inside = 0;
      for (int step = 0; step < 60; ++step) {
        const double between = (outside + inside) / 2;
        ((line + between * d - sphere).norm() > radii ? outside : inside) = between;
      }
      return outside;
    };
    const double in_nest = touches(setup.nest.value());
    double bend = 0;
    for (std::size_t k = 0; k < readings.count(); ++k) {
      const Eigen::Vector3d sphere = test::seen_from_workpiece(machine, errors, plan.poses.pose(k), kSphere);
      EXPECT_NEAR(readings.measured[i][k], touches(sphere) - in_nest + probe.zero.value, 1e-9);
      bend = std::max(bend, std::abs(d.dot(sphere - setup.nest.value()) + probe.zero.value - readings.measured[i][k]));
    }
    EXPECT_GT(bend, 1e-3) << "the poses do not show the difference to a flat tip";
  }
}

TEST(RTest, DerivativesEqualDifferences) {
  // Balls of some 10 mm bend within the differences' steps of up to 40 um.
  for (const Machine& machine : {test::trunnion_mill(), test::head_table_mill(), test::gantry_fork_head()}) {
    for (const RTestSetup::Tip tip : {RTestSetup::Tip::flat, RTestSetup::Tip::ball}) {
      const auto nest = std::make_shared<RTest>(cosy_nest(machine, tip));
      test::expect_jacobian_equals_differences(machine, test::some_errors(machine), nest,
                                               test::meeting_plan(machine, *nest, 0.5, 0.4, 15), 5e-6);
    }
  }
}

TEST(RTest, DerivativesEqualDifferencesWhenMostOfTheSetUpIsExact) {
  const Machine machine = test::trunnion_mill();
  RTestSetup setup = cosy_nest(machine, RTestSetup::Tip::ball);
  setup.sphere_radius.knowledge = Knowledge::exact;
  for (RTestSetup::Probe& probe : setup.probes) {
    for (SetupNumber* number : {&probe.tilt_first, &probe.tilt_second, &probe.offset_first, &probe.offset_second}) {
      number->knowledge = Knowledge::exact;
    }
  }
  for (const std::size_t estimated : {9U, 4U, 3U}) {
    if (estimated < 9) {
      for (SetupNumber& number : setup.nest.coordinate) number.knowledge = Knowledge::exact;
      setup.spheres[0].centre = SetupPoint::exact(kSphere);
      // An unknown behind an exact number of the same kind.
      if (estimated == 4) setup.nest.coordinate[1].knowledge = Knowledge::open;
    }
    const auto nest = std::make_shared<RTest>(setup);
    std::size_t unknowns = 0;
    for (const SetupQuantity& q : nest->quantities()) unknowns += q.knowledge != Knowledge::exact ? 1U : 0U;
    EXPECT_EQ(unknowns, estimated);
    test::expect_jacobian_equals_differences(machine, test::some_errors(machine), nest,
                                             test::meeting_plan(machine, *nest, 0.5, 0.4, 15), 5e-6);
  }
}

TEST(RTest, NestInTheSpindleSeesTheSphereOnTheTable) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  RTestSetup setup = cosy_nest(machine, RTestSetup::Tip::flat);
  std::swap(setup.nest_body, setup.sphere_body);
  std::swap(setup.nest, setup.spheres[0].centre);
  const auto nest = std::make_shared<RTest>(setup);
  const InstrumentReadings plan = test::meeting_plan(machine, *nest, 0.3, 0.5, 15);
  const InstrumentReadings readings = test::exact_readings(machine, errors, nest, plan);
  for (std::size_t k = 0; k < readings.count(); ++k) {
    const RigidTransform tool = actual_workpiece_from_tool(machine, errors, plan.poses.pose(k));
    const Eigen::Vector3d sphere = tool.inverse() * setup.spheres[0].centre.value() + machine.tool_offset;
    for (std::size_t i = 0; i < 3; ++i) {
      const double expected = plunger(setup.probes[i]).dot(sphere - kSphere) + setup.probes[i].zero.value;
      EXPECT_NEAR(readings.measured[i][k], expected, 1e-9);
    }
  }
  test::expect_jacobian_equals_differences(machine, errors, nest, plan);
}

TEST(RTest, ZerosAndNestPositionCannotBeToldApart) {
  const Machine machine = test::trunnion_mill();
  const RTestSetup setup = cosy_nest(machine, RTestSetup::Tip::flat);
  RTestSetup other = setup;
  const Eigen::Vector3d shift(0.02, -0.03, 0.01);
  other.nest = SetupPoint::open(setup.nest.value() + shift);
  for (RTestSetup::Probe& probe : other.probes) probe.zero.value += plunger(probe).dot(shift);
  const auto a = std::make_shared<RTest>(setup), b = std::make_shared<RTest>(other);
  const InstrumentReadings plan = test::meeting_plan(machine, *a, 0.5, 0.5, 10);
  const InstrumentReadings of_a = test::exact_readings(machine, test::some_errors(machine), a, plan);
  const InstrumentReadings of_b = test::exact_readings(machine, test::some_errors(machine), b, plan);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < plan.count(); ++k) EXPECT_NEAR(of_a.measured[i][k], of_b.measured[i][k], 1e-10);
  }
}

TEST(RTest, HasNoIndicationWhereThePlungerMissesTheSphere) {
  const Machine machine = test::trunnion_mill();
  const auto nest = std::make_shared<RTest>(cosy_nest(machine, RTestSetup::Tip::ball));
  InstrumentReadings plan;
  std::vector<double> far =
      *meet(machine, test::middle(machine), Body::tool, Body::workpiece, *nest->meeting_points(0), {0, 0, 100});
  plan.append(far, 0);
  const InstrumentReadings readings = test::exact_readings(machine, ErrorSet{}, nest, plan);
  EXPECT_TRUE(std::isnan(readings.measured[0][0]));
}

TEST(RTest, RefusesASetupThatIsNone) {
  const Machine machine = test::trunnion_mill();
  const RTestSetup good = cosy_nest(machine, RTestSetup::Tip::ball);
  RTestSetup bad = good;
  bad.spheres.clear();
  EXPECT_THROW(RTest{bad}, std::invalid_argument);
  bad = good;
  bad.probes.clear();
  EXPECT_THROW(RTest{bad}, std::invalid_argument);
  bad = good;
  bad.probes.resize(5, bad.probes[0]);
  EXPECT_THROW(RTest{bad}, std::invalid_argument);
  bad = good;
  bad.probes[1].direction.setZero();
  EXPECT_THROW(RTest{bad}, std::invalid_argument);
  bad = good;
  bad.probes[1].tip_radius = -1;
  EXPECT_THROW(RTest{bad}, std::invalid_argument);
}

}  // namespace
}  // namespace abbe
