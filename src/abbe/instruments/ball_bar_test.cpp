#include "abbe/instruments/ball_bar.h"

#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/instruments/path_plan.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

BallBarSetup two_balls() {
  BallBarSetup setup;
  setup.name = "bar";
  setup.spindle_ball = SetupPoint::within({0.01, -0.02, -120}, 0.005);
  setup.balls = {{"centre", SetupPoint::open({20, 10, 60})}, {"edge", SetupPoint::open({80, -30, 90})}};
  setup.length_deviation = SetupNumber::within(0.003, 0.0005);
  return setup;
}

/// Circles of 100 mm in three planes about both balls, and a turn of the table with the bar held radially.
InstrumentReadings circles(const Machine& machine, const Instrument& bar) {
  InstrumentReadings plan;
  const Eigen::Vector3d axes[] = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};
  for (std::size_t item = 0; item < bar.items().size(); ++item) {
    for (std::size_t plane = 0; plane < 3; ++plane) {
      CircleDescription circle;
      circle.u = axes[plane];
      circle.v = axes[(plane + 1) % 3];
      circle.radius = 100;
      circle.from_angle = plane == 0 ? 0 : 0.3;
      circle.to_angle = plane == 0 ? kTurn : 2.5;
      circle.count = 15;
      const PoseList poses = circle_plan(machine, std::vector<double>(machine.axes.size(), 0.0), Body::tool,
                                         Body::workpiece, *bar.meeting_points(item), circle);
      for (std::size_t k = 0; k < poses.count(); ++k) plan.append(poses.pose(k), item);
    }
    PoseList turn;
    for (const double c : evenly_spaced(0, kTurn, 9)) {
      std::vector<double> positions(machine.axes.size(), 0.0);
      positions[machine.find_axis("C")] = c;
      turn.append(positions);
    }
    const PoseList poses =
        follow_plan(machine, turn, Body::tool, Body::workpiece, *bar.meeting_points(item), {60, 80, 0});
    for (std::size_t k = 0; k < poses.count(); ++k) plan.append(poses.pose(k), item);
  }
  return plan;
}

TEST(BallBar, ReadsItsLengthOnAPerfectMachine) {
  const Machine machine = test::trunnion_mill();
  const auto bar = std::make_shared<BallBar>(two_balls());
  const InstrumentReadings plan = circles(machine, *bar);
  const InstrumentReadings readings = test::exact_readings(machine, ErrorSet{}, bar, plan);
  for (const double length : readings.measured[0]) EXPECT_NEAR(length, 100.003, 1e-9);
}

TEST(BallBar, EqualsTheDistanceOfTheBallsOnTheActualMachine) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  const auto bar = std::make_shared<BallBar>(two_balls());
  const InstrumentReadings plan = circles(machine, *bar);
  const InstrumentReadings readings = test::exact_readings(machine, errors, bar, plan);
  for (std::size_t k = 0; k < readings.count(); ++k) {
    const RigidTransform tool = actual_workpiece_from_tool(machine, errors, plan.poses.pose(k));
    const MeetingPoints points = *bar->meeting_points(plan.item[k]);
    // The tool's frame stands at the functional point, the ball counts from the gauge point.
    const Eigen::Vector3d spindle = tool * Eigen::Vector3d(points.on_from - machine.tool_offset);
    EXPECT_NEAR(readings.measured[0][k], (spindle - points.on_to).norm() + 0.003, 1e-9) << k;
  }
}

TEST(BallBar, DerivativesEqualDifferences) {
  const auto bar = std::make_shared<BallBar>(two_balls());
  const Machine trunnion = test::trunnion_mill();
  test::expect_jacobian_equals_differences(trunnion, test::some_errors(trunnion), bar, circles(trunnion, *bar));
  for (const Machine& machine : {test::head_table_mill(), test::gantry_fork_head(), test::wang_grinder()}) {
    InstrumentReadings plan;
    const PoseList poses = random_plan(machine, full_ranges(machine, 2), 40, 3);
    for (std::size_t k = 0; k < poses.count(); ++k) plan.append(poses.pose(k), k % 2);
    test::expect_jacobian_equals_differences(machine, test::some_errors(machine), bar, plan);
  }
}

TEST(BallBar, ReversalOfAnAxisIsSeenWithItsDerivative) {
  const Machine machine = test::trunnion_mill();
  const auto bar = std::make_shared<BallBar>(two_balls());
  ErrorSet errors = test::some_errors(machine);
  for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
    errors.reversals.push_back({axis, machine.axes[axis].kind == AxisKind::rotary ? -4e-5 : -0.011, 0});
  }
  InstrumentReadings plan = circles(machine, *bar);
  const InstrumentReadings mean = test::exact_readings(machine, errors, bar, plan);
  plan.poses.approach = approach_in_order(plan.poses);
  test::expect_jacobian_equals_differences(machine, errors, bar, plan);
  const InstrumentReadings directed = test::exact_readings(machine, errors, bar, plan);
  for (std::vector<std::int8_t>& sides : plan.poses.approach) {
    for (std::int8_t& side : sides) side = static_cast<std::int8_t>(-side);
  }
  const InstrumentReadings opposite = test::exact_readings(machine, errors, bar, plan);
  double largest = 0;
  for (std::size_t k = 0; k < plan.count(); ++k) {
    // Both directions lie about their mean; half of 11 um is seen along X or Y.
    EXPECT_NEAR((directed.measured[0][k] + opposite.measured[0][k]) / 2, mean.measured[0][k], 1e-6);
    largest = std::max(largest, std::abs(directed.measured[0][k] - mean.measured[0][k]));
  }
  EXPECT_GT(largest, 0.005);
  EXPECT_LT(largest, 0.02);
}

TEST(BallBar, MayHangTheOtherWayRound) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  const BallBarSetup setup = two_balls();
  BallBarSetup turned = setup;
  turned.spindle_body = Body::workpiece;
  turned.spindle_ball = setup.balls[0].centre;
  turned.table_body = Body::tool;
  turned.balls = {{"spindle", setup.spindle_ball}};
  InstrumentReadings plan = circles(machine, BallBar(setup));
  std::vector<std::size_t> first;
  for (std::size_t k = 0; k < plan.count(); ++k) {
    if (plan.item[k] == 0) first.push_back(k);
  }
  plan = plan.subset(first);
  const auto usual = std::make_shared<BallBar>(setup), other = std::make_shared<BallBar>(turned);
  const InstrumentReadings a = test::exact_readings(machine, errors, usual, plan);
  const InstrumentReadings b = test::exact_readings(machine, errors, other, plan);
  for (std::size_t k = 0; k < plan.count(); ++k) EXPECT_NEAR(a.measured[0][k], b.measured[0][k], 1e-9);
  test::expect_jacobian_equals_differences(machine, errors, other, plan);
}

TEST(BallBar, RepeatsNoiseOfTheStatedSize) {
  const Machine machine = test::trunnion_mill();
  const auto bar = std::make_shared<BallBar>(two_balls());
  InstrumentReadings plan;
  for (int k = 0; k < 10; ++k) plan.append(circles(machine, *bar));
  InstrumentSimulationOptions options;
  const InstrumentReadings noisy = simulate_instrument(machine, ErrorSet{}, bar, plan, options).readings;
  const InstrumentReadings again = simulate_instrument(machine, ErrorSet{}, bar, plan, options).readings;
  EXPECT_EQ(noisy.measured, again.measured);
  double square = 0;
  for (const double length : noisy.measured[0]) square += std::pow(length - 100.003, 2);
  EXPECT_NEAR(std::sqrt(square / static_cast<double>(noisy.count())), 0.1e-3, 0.01e-3);
}

TEST(InstrumentReadings, ThatDoNotFitTheInstrumentAreRefused) {
  const Machine machine = test::trunnion_mill();
  const auto bar = std::make_shared<BallBar>(two_balls());
  const InstrumentReadings good = test::exact_readings(machine, ErrorSet{}, bar, circles(machine, *bar));
  InstrumentReadings bad = good;
  bad.item[3] = 2;
  EXPECT_THROW(check_readings(machine, *bar, bad), std::invalid_argument);
  bad = good;
  bad.measured[0][5] = std::nan("");
  EXPECT_THROW(check_readings(machine, *bar, bad), std::invalid_argument);
  bad = good;
  bad.measured[0].pop_back();
  EXPECT_THROW(check_readings(machine, *bar, bad), std::invalid_argument);
  bad = good;
  bad.uncertainty.assign(1, std::vector<double>(good.count(), 0.0));
  EXPECT_THROW(check_readings(machine, *bar, bad), std::invalid_argument);
  EXPECT_THROW(check_readings(machine, *bar, InstrumentReadings{}), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
