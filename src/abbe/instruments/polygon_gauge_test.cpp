#include "abbe/instruments/polygon_gauge.h"

#include <numbers>

#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/interferometer.h"
#include "abbe/instruments/polygon_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// A bare rotary table in the machine's origin, turning in its own positive sense.
Machine rotary_table() {
  Machine machine;
  machine.name = "rotary table";
  Axis c{.name = "C", .kind = AxisKind::rotary, .side = ChainSide::workpiece};
  c.direction = Eigen::Vector3d::UnitZ();
  c.travel_max = kTurn;
  machine.axes = {c};
  return machine;
}

PolygonGaugeSetup some_prism(std::uint64_t seed, double angle = 5e-4, double length = 0.05) {
  PolygonGaugeSetup setup;
  const test::PolygonCase c = test::random_polygon(12, angle, length, seed);
  setup.polygon = c.polygon;
  setup.bench = c.bench;
  setup.shifts = {0, 1};
  RandomStream random(seed + 1);
  for (int m = 0; m < 2; ++m) {
    setup.mounts.push_back({test::random_vector(random, angle), test::random_vector(random, length), 0});
  }
  for (std::size_t i = 0; i < kPolygonReadings; ++i) setup.zeros[i] = random.uniform(-1, 1) * (i < 4 ? angle : length);
  setup.top_knowledge.knowledge = Knowledge::open;
  return setup;
}

TEST(PolygonGauge, OnABareTableReadsWhatTheTableOfThePaperReads) {
  const Machine machine = rotary_table();
  ErrorSet errors;
  TableMotion motion;
  // Constant error motions that both orders of composition place alike.
  motion.angles << 0, 0, 3e-4;
  motion.displacement << 0.02, -0.03, 0.01;
  const Component components[] = {Component::X, Component::Y, Component::Z, Component::C};
  const double values[] = {0.02, -0.03, 0.01, 3e-4};
  for (std::size_t i = 0; i < 4; ++i) {
    errors.motions.push_back(
        {0, components[i], {.kind = BasisKind::fourier, .order = 0, .to = kTurn, .period = kTurn}, {values[i]}, {}});
  }
  const PolygonGaugeSetup setup = some_prism(3);
  const auto gauge = std::make_shared<PolygonGauge>(setup);
  const InstrumentReadings readings =
      test::exact_readings(machine, errors, gauge, polygon_plan(machine, *gauge, 0, {0}));
  ASSERT_EQ(readings.count(), 24U);
  for (std::size_t k = 0; k < 24; ++k) {
    const std::size_t m = k / 12;
    PolygonMount mount = setup.mounts[m];
    mount.turn = kTurn * static_cast<double>(setup.shifts[m]) / 12;
    const PolygonPosition position = regular_position(12, k % 12, setup.shifts[m]);
    const PolygonReadings expected = polygon_readings(setup.polygon, mount, setup.bench, position, motion);
    for (std::size_t i = 0; i < setup.measured.size(); ++i) {
      const std::size_t reading = static_cast<std::size_t>(setup.measured[i]);
      EXPECT_NEAR(readings.measured[i][k], expected[reading] + setup.zeros[reading], i < 3 ? 3e-15 : 1e-12)
          << gauge->items()[readings.item[k]].name << " " << reading_name(setup.measured[i]);
    }
  }
}

TEST(PolygonGauge, DerivativesEqualDifferencesOnAnyMachine) {
  // On a table that an inclined cradle carries, its sensors on the bed; and with the sensors on the spindle.
  const Machine machine = test::trunnion_mill();
  for (const Body sensors : {Body::bed, Body::tool}) {
    PolygonGaugeSetup setup = some_prism(11);
    setup.sensor_body = sensors;
    setup.table_from_prism = RigidTransform::translate({0, 0, 30});
    std::vector<double> positions(machine.axes.size(), 0.0);
    positions[machine.find_axis("A")] = sensors == Body::bed ? -0.5 : 0.0;
    const Eigen::Matrix3d seen = nominal_orientation(machine, positions, Body::workpiece, sensors);
    setup.sensors_from_bench = {seen, {40, -20, 15}};
    const auto gauge = std::make_shared<PolygonGauge>(setup);
    const InstrumentReadings plan = polygon_plan(machine, *gauge, machine.find_axis("C"), positions);
    test::expect_jacobian_equals_differences(machine, test::some_errors(machine), gauge, plan);
  }
}

TEST(PolygonGauge, APrimedAxisShowsItsFacesInTheOtherOrder) {
  const Machine machine = test::trunnion_mill();
  const PolygonGauge gauge(some_prism(5));
  const InstrumentReadings plan =
      polygon_plan(machine, gauge, machine.find_axis("C"), std::vector<double>(machine.axes.size(), 0.0));
  // The table turns the other way: after the first face comes the last.
  EXPECT_EQ(gauge.items()[plan.item[0]].name, "mount1.face1");
  EXPECT_EQ(gauge.items()[plan.item[1]].name, "mount1.face12");
  EXPECT_EQ(gauge.items()[plan.item[12]].name, "mount2.face2");
}

TEST(PolygonGauge, PositionsBetweenTheFacesAreRefused) {
  const Machine machine = rotary_table();
  const PolygonGauge gauge(some_prism(5));
  EXPECT_THROW(polygon_plan(machine, gauge, 0, {0.2}), std::invalid_argument);
  EXPECT_NO_THROW(polygon_plan(machine, gauge, 0, {0.001}));
}

TEST(PolygonGauge, SetUpsThatMakeNoSenseAreRefused) {
  const auto refused = [](const auto& change) {
    PolygonGaugeSetup setup = some_prism(1);
    change(setup);
    EXPECT_THROW(PolygonGauge{setup}, std::invalid_argument);
  };
  refused([](PolygonGaugeSetup& s) { s.polygon = regular_polygon(10, 48.3, 17); });
  refused([](PolygonGaugeSetup& s) { s.polygon.order = PolygonFaceOrder::paper; });
  refused([](PolygonGaugeSetup& s) { s.shifts = {}; });
  refused([](PolygonGaugeSetup& s) { s.shifts = {0, 1, 2}; });
  refused([](PolygonGaugeSetup& s) { s.measured = {}; });
  refused([](PolygonGaugeSetup& s) { s.measured = {PolygonReading::displacement_x, PolygonReading::displacement_x}; });
  refused([](PolygonGaugeSetup& s) { s.noise.angle = 0; });
  refused([](PolygonGaugeSetup& s) { s.bench.displacement_x.position.z() = 40; });
}

TEST(PolygonGauge, MayMeasureWithOneAutocollimatorOnly) {
  const Machine machine = rotary_table();
  PolygonGaugeSetup setup = some_prism(9);
  setup.measured = {PolygonReading::autocollimator_x_about_z, PolygonReading::autocollimator_x_about_y};
  const auto gauge = std::make_shared<PolygonGauge>(setup);
  EXPECT_EQ(gauge->components().size(), 2U);
  test::expect_jacobian_equals_differences(machine, test::some_errors(machine), gauge,
                                           polygon_plan(machine, *gauge, 0, {0}));
}

}  // namespace
}  // namespace abbe
