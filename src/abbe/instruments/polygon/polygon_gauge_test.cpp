#include "abbe/instruments/polygon/polygon_gauge.h"

#include <fmt/format.h>

#include "abbe/geometry/angle_units.h"
#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/polygon/polygon_for_test.h"
#include "abbe/instruments/polygon/polygon_placement.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

PolygonGaugeSetup some_prism(std::uint64_t seed, double angle = 5e-4, double length = 0.05) {
  PolygonGaugeSetup setup;
  const test::PolygonCase c = test::random_polygon(12, angle, length, seed);
  setup.polygon = c.polygon;
  setup.top = {SetupNumber::open(c.polygon.top.tilt_x), SetupNumber::open(c.polygon.top.tilt_y)};
  setup.bench = c.bench;
  RandomStream random(seed + 1);
  setup.mounts.clear();
  for (std::size_t m = 0; m < 2; ++m) {
    PolygonGaugeSetup::Mount mount{fmt::format("mount{}", m + 1), m};
    for (std::size_t i = 0; i < 6; ++i) mount.numbers[i].value = random.uniform(-1, 1) * (i < 3 ? angle : length);
    setup.mounts.push_back(mount);
  }
  for (const PolygonReading reading : setup.steps[0].measured) {
    setup.steps[0].zeros.push_back(SetupNumber::open(random.uniform(-1, 1) * (is_angle(reading) ? angle : length)));
  }
  return setup;
}

/// The set-up's numbers as the model of the table alone takes them.
PolygonMount mount_of(const PolygonGaugeSetup& setup, std::size_t m) {
  const auto& n = setup.mounts[m].numbers;
  return {{n[0].value, n[1].value, n[2].value},
          {n[3].value, n[4].value, n[5].value},
          kTurn * static_cast<double>(setup.mounts[m].turned_by) / 12};
}

/// On the table of a machine, its face at `height` over the origin of the table's frame.
void place(const Machine& machine, const char* axis, double height, Body sensors, std::vector<double> at,
           PolygonGaugeSetup& setup) {
  PolygonPlacement placement;
  placement.axis = machine.find_axis(axis);
  placement.sensor_body = sensors;
  placement.centre = {0, 0, height};
  placement.top = nominal_seen(machine, at, Body::workpiece, sensors).rotation.col(2);
  placement.toward_x = nominal_seen(machine, at, Body::workpiece, sensors).rotation.col(0);
  placement.aligned_at = std::move(at);
  place_polygon(machine, placement, setup);
}

TEST(PolygonGauge, OnABareTableReadsWhatTheTableOfThePaperReads) {
  const Machine machine = test::rotary_table();
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
    const PolygonPosition position = regular_position(12, k % 12, m);
    const PolygonReadings expected = polygon_readings(setup.polygon, mount_of(setup, m), setup.bench, position, motion);
    const PolygonGaugeSetup::Step& step = setup.steps[0];
    for (std::size_t i = 0; i < step.measured.size(); ++i) {
      EXPECT_NEAR(readings.measured[i][k], expected[static_cast<std::size_t>(step.measured[i])] + step.zeros[i].value,
                  i < 3 ? 3e-15 : 1e-12)
          << gauge->items()[readings.item[k]].name << " " << reading_name(step.measured[i]);
    }
  }
}

TEST(PolygonGauge, DerivativesEqualDifferencesOnAnyMachine) {
  // On a table that an inclined cradle carries, its sensors on the bed; and with the sensors on the spindle.
  const Machine machine = test::trunnion_mill();
  for (const Body sensors : {Body::bed, Body::tool}) {
    PolygonGaugeSetup setup = some_prism(11);
    std::vector<double> positions(machine.axes.size(), 0.0);
    positions[machine.find_axis("A")] = sensors == Body::bed ? -0.5 : 0.0;
    place(machine, "C", 30, sensors, positions, setup);
    const auto gauge = std::make_shared<PolygonGauge>(setup);
    const InstrumentReadings plan = polygon_plan(machine, *gauge, machine.find_axis("C"), positions);
    test::expect_jacobian_equals_differences(machine, test::some_errors(machine), gauge, plan);
  }
}

TEST(PolygonGauge, APrimedAxisShowsItsFacesInTheOtherOrder) {
  const Machine machine = test::trunnion_mill();
  PolygonGaugeSetup setup = some_prism(5);
  place(machine, "C", 0, Body::bed, std::vector<double>(machine.axes.size(), 0.0), setup);
  const PolygonGauge gauge(setup);
  const InstrumentReadings plan =
      polygon_plan(machine, gauge, machine.find_axis("C"), std::vector<double>(machine.axes.size(), 0.0));
  // The table turns the other way: after the first face comes the last.
  EXPECT_EQ(gauge.items()[plan.item[0]].name, "mount1.face1");
  EXPECT_EQ(gauge.items()[plan.item[1]].name, "mount1.face12");
  EXPECT_EQ(gauge.items()[plan.item[12]].name, "mount2.face2");
}

TEST(PolygonGauge, PositionsBetweenTheFacesAreRefused) {
  const Machine machine = test::rotary_table();
  const PolygonGauge gauge(some_prism(5));
  EXPECT_THROW(polygon_plan(machine, gauge, 0, {0.2}), std::invalid_argument);
  EXPECT_NO_THROW(polygon_plan(machine, gauge, 0, {0.001}));
}

TEST(PolygonGauge, ABeamThatMissesThePrismIsRefused) {
  const Machine machine = test::trunnion_mill();
  PolygonGaugeSetup setup = some_prism(5);
  std::vector<double> at(machine.axes.size(), 0.0);
  place(machine, "C", 0, Body::bed, at, setup);
  const PolygonGauge gauge(setup);
  EXPECT_EQ(gauge.item_at(machine, 1, 0, at), 12U + 1U);
  at[machine.find_axis("Y")] = 12;  // the table carries the prism aside
  EXPECT_NO_THROW(gauge.item_at(machine, 0, 0, at));
  at[machine.find_axis("Y")] = 14;  // half a face is 12.9 mm
  EXPECT_THROW(gauge.item_at(machine, 0, 0, at), std::invalid_argument);
}

TEST(PolygonGauge, StepwiseReadsTheSameOneAfterTheOther) {
  using enum PolygonReading;
  const Machine machine = test::rotary_table();
  const ErrorSet errors = test::some_errors(machine);
  PolygonGaugeSetup whole = some_prism(13);
  whole.steps = {PolygonGaugeSetup::all_at_once()};
  PolygonGaugeSetup setup = whole;
  setup.steps = {{"x", {autocollimator_x_about_z, autocollimator_x_about_y, displacement_y}, {}},
                 {"y", {autocollimator_y_about_z, autocollimator_y_about_x, displacement_x}, {}},
                 {"z", {autocollimator_y_about_z, autocollimator_y_about_x, displacement_z}, {}}};
  const auto gauge = std::make_shared<PolygonGauge>(setup);
  EXPECT_EQ(gauge->target_names(),
            (std::vector<std::string>{"mount1.x", "mount1.y", "mount1.z", "mount2.x", "mount2.y", "mount2.z"}));
  EXPECT_EQ(gauge->components()[1].name, "autocollimator_tilt");
  EXPECT_EQ(gauge->target_of(gauge->item_at(machine, 4, 0, {0})), 4U);
  const InstrumentReadings plan = polygon_plan(machine, *gauge, 0, {0});
  ASSERT_EQ(plan.count(), 72U);
  test::expect_jacobian_equals_differences(machine, errors, gauge, plan);
  const auto at_once = std::make_shared<PolygonGauge>(whole);
  const InstrumentReadings all =
      test::exact_readings(machine, errors, at_once, polygon_plan(machine, *at_once, 0, {0}));
  const InstrumentReadings steps = test::exact_readings(machine, errors, gauge, plan);
  const std::size_t same[3][3] = {{0, 1, 4}, {6, 2, 3}, {6, 2, 5}};  // component of the whole; 6: redundant
  for (std::size_t k = 0; k < 72; ++k) {
    const std::size_t mount = k / 36, step = k / 12 % 3, position = k % 12;
    for (std::size_t i = 0; i < 3; ++i) {
      if (same[step][i] == 6) continue;
      EXPECT_DOUBLE_EQ(steps.measured[i][k], all.measured[same[step][i]][12 * mount + position]) << k << " " << i;
    }
  }
}

TEST(PolygonGauge, SetUpsThatMakeNoSenseAreRefused) {
  const auto refused = [](const auto& change) {
    PolygonGaugeSetup setup = some_prism(1);
    change(setup);
    EXPECT_THROW(PolygonGauge{setup}, std::invalid_argument);
  };
  refused([](PolygonGaugeSetup& s) { s.polygon = regular_polygon(10, 48.3, 17); });
  refused([](PolygonGaugeSetup& s) { s.polygon.order = PolygonFaceOrder::paper; });
  refused([](PolygonGaugeSetup& s) { s.mounts = {}; });
  refused([](PolygonGaugeSetup& s) { s.faces.resize(11); });
  refused([](PolygonGaugeSetup& s) { s.steps[0].measured = {}; });
  refused([](PolygonGaugeSetup& s) {
    s.steps = {{"", {PolygonReading::displacement_x, PolygonReading::displacement_x}, {}}};
  });
  refused([](PolygonGaugeSetup& s) {
    s.steps = {{"x", {PolygonReading::displacement_x}, {}}, {"y", {PolygonReading::autocollimator_x_about_z}, {}}};
  });
  refused([](PolygonGaugeSetup& s) { s.steps[0].zeros.pop_back(); });
  refused([](PolygonGaugeSetup& s) { s.noise.angle = 0; });
  refused([](PolygonGaugeSetup& s) { s.bench.displacement_x.position.z() = 40; });
}

TEST(PolygonGauge, MayMeasureWithOneAutocollimatorOnly) {
  const Machine machine = test::rotary_table();
  PolygonGaugeSetup setup = some_prism(9);
  setup.steps = {{"", {PolygonReading::autocollimator_x_about_z, PolygonReading::autocollimator_x_about_y}, {}}};
  const auto gauge = std::make_shared<PolygonGauge>(setup);
  EXPECT_EQ(gauge->components().size(), 2U);
  test::expect_jacobian_equals_differences(machine, test::some_errors(machine), gauge,
                                           polygon_plan(machine, *gauge, 0, {0}));
}

}  // namespace
}  // namespace abbe
