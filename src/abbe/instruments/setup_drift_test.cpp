#include "abbe/instruments/setup_drift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/r_test.h"
#include "abbe/instruments/trackers/laser_tracker.h"
#include "abbe/instruments/trackers/tracker_observations.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

/// All six motions, with a polynomial and a walk, over an hour.
std::shared_ptr<SetupDrift> some_drift(const Eigen::Vector3d& pivot, double size = 1) {
  auto drift = std::make_shared<SetupDrift>();
  DriftingPlace& place = drift->places.emplace_back();
  place.name = "place";
  place.pivot = pivot;
  place.components = {0, 1, 2, 3, 4, 5};
  place.start_s = 100;
  place.end_s = 3700;
  place.degree = 2;
  place.knots_s = {100, 500, 2000, 3700};
  RandomStream random(3);
  for (const SetupUnknown& unknown : drift->unknowns()) {
    drift->values.push_back(size * random.uniform(-1, 1) * (unknown.is_angle ? 1e-3 : 0.5));
  }
  return drift;
}

InstrumentReadings timed(InstrumentReadings plan, std::shared_ptr<const SetupDrift> drift) {
  plan.drift = std::move(drift);
  for (std::size_t k = 0; k < plan.count(); ++k) {
    plan.time_s.push_back(100 + 3600.0 * static_cast<double>(k) / static_cast<double>(plan.count() - 1));
  }
  return plan;
}

TrackerSetup one_station(const Eigen::Vector3d& at, const Eigen::Vector3d& turn) {
  TrackerSetup setup;
  TrackerStation station;
  station.name = "S1";
  station.body_from_tracker = {rotation_from_vector(turn), at};
  station.noise = TrackerNoise::isotropic(5, 0);
  setup.stations = {station};
  setup.reflectors = {{.name = "R1", .offset = {30, -20, 10}}, {.name = "R2", .offset = {-60, 40, 5}}};
  return setup;
}

TEST(SetupDrift, FunctionsArePolynomialAndStraightLines) {
  const std::shared_ptr<SetupDrift> drift = some_drift({0, 0, 0});
  const DriftingPlace& place = drift->places[0];
  double weights[5];
  drift_functions(place, 100, weights);
  for (const double weight : weights) EXPECT_EQ(weight, 0);
  drift_functions(place, 1900, weights);  // the middle: s = 1/2
  EXPECT_DOUBLE_EQ(weights[0], 0.5);
  EXPECT_DOUBLE_EQ(weights[1], 0.25);
  EXPECT_DOUBLE_EQ(weights[2], 1 - 1400.0 / 1500);
  EXPECT_DOUBLE_EQ(weights[3], 1400.0 / 1500);
  EXPECT_EQ(weights[4], 0);
  drift_functions(place, 3700, weights);
  EXPECT_EQ(weights[4], 1);
  EXPECT_EQ(drift->unknowns()[2].name, "place.drift_x(0.111111 h)");
}

TEST(SetupDrift, DerivativesOfAnyInstrumentEqualDifferences) {
  const Machine machine = parse_chain("w C' X' Y' b Z t").machine;
  RTestSetup setup;
  setup.nest = SetupPoint::open({40, 30, 120});
  setup.spheres = {{"sphere", SetupPoint::exact({0, 0, -80})}};
  setup.probes.resize(3);
  for (std::size_t i = 0; i < 3; ++i) {
    setup.probes[i].name = "probe" + std::to_string(i + 1);
    setup.probes[i].direction = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(i)) + Eigen::Vector3d(0.1, 0.2, 0.3);
    setup.probes[i].zero = SetupNumber::open(0.01);
  }
  const auto nest = std::make_shared<const RTest>(setup);
  test::expect_jacobian_equals_differences(machine, test::some_errors(machine), nest,
                                           timed(test::anywhere(machine, 60), some_drift({10, -20, 30})), 1e-6);
}

/// The same for trackers, whose observations are their own.
TEST(SetupDrift, DerivativesOfTrackersEqualDifferences) {
  const Machine machine = parse_chain("w C' X' Y' b Z t").machine;
  const ErrorSet errors = test::some_errors(machine);
  for (const TrackerMeasure measure : {TrackerMeasure::cartesian, TrackerMeasure::range_and_angles}) {
    const auto tracker =
        std::make_shared<const LaserTracker>("tracker", one_station({900, 700, 150}, {0.2, -0.1, 2}), measure);
    InstrumentSimulationOptions options;
    options.noise_factor = 0;
    options.line_of_sight = false;
    const InstrumentReadings plan = timed(test::anywhere(machine, 40), some_drift({850, 650, 100}));
    InstrumentReadings readings = tracker->simulate(machine, errors, plan, options).readings;
    ASSERT_EQ(readings.count(), plan.count());
    const std::unique_ptr<Observations> observations = tracker->observations(machine, errors, readings);
    const std::vector<double> start = errors.parameters(), setup = observations->unknown_values();
    ASSERT_EQ(setup.size(), 6 + plan.drift->unknown_count());
    std::vector<std::size_t> parameters(start.size()), unknowns(setup.size());
    std::iota(parameters.begin(), parameters.end(), std::size_t{0});
    std::iota(unknowns.begin(), unknowns.end(), std::size_t{0});
    const std::size_t length = 3 * readings.count();
    std::vector<double> residuals(length), jacobian((start.size() + setup.size()) * length);
    observations->evaluate(0, readings.count(), parameters, unknowns, residuals.data(), jacobian.data(), length);
    // 1e-12 mm over 5 um: simulation and model agree, drift included.
    for (const double residual : residuals) ASSERT_NEAR(residual, 0, 1e-6);
    std::vector<double> above(length), below(length);
    const std::vector<bool> angles = parameters_are_angles(machine, errors);
    for (std::size_t column = 0; column < start.size() + setup.size(); ++column) {
      const bool of_machine = column < start.size();
      const bool is_angle = of_machine ? angles[column] : observations->unknowns()[column - start.size()].is_angle;
      const double step = is_angle ? 1e-6 : 1e-3;
      for (double* side : {above.data(), below.data()}) {
        std::vector<double> moved = start, moved_setup = setup;
        (of_machine ? moved[column] : moved_setup[column - start.size()]) += side == above.data() ? step : -step;
        observations->set_parameters(moved, moved_setup);
        observations->evaluate(0, readings.count(), {}, {}, side, nullptr, 0);
      }
      for (std::size_t i = 0; i < length; ++i) {
        const double difference = (below[i] - above[i]) / (2 * step), analytic = jacobian[column * length + i];
        ASSERT_NEAR(analytic, difference, 2e-6 * std::max(1e2, std::abs(analytic))) << column << ", " << i;
      }
    }
  }
}

/// What a station sees that has drifted is what one sees that stands there.
TEST(SetupDrift, IsAStationThatStandsElsewhere) {
  const Machine machine = parse_chain("w C' X' Y' b Z t").machine;
  const ErrorSet errors = test::some_errors(machine);
  const Eigen::Vector3d at(900, 700, 150), turn(0.2, -0.1, 2);
  const std::shared_ptr<SetupDrift> drift = some_drift(at);
  const auto tracker =
      std::make_shared<const LaserTracker>("tracker", one_station(at, turn), TrackerMeasure::cartesian);
  InstrumentSimulationOptions options;
  options.noise_factor = 0;
  options.line_of_sight = false;
  InstrumentReadings plan = test::anywhere(machine, 12);
  plan.time_s.assign(plan.count(), 3700);
  plan.drift = drift;
  const InstrumentReadings drifted = tracker->simulate(machine, errors, plan, options).readings;
  // At the end: the sum of the coefficients and the value at the last knot.
  Eigen::Matrix<double, 6, 1> motion;
  for (std::size_t c = 0; c < 6; ++c) {
    const std::size_t first = drift->first_unknown(0, c);
    motion[static_cast<Eigen::Index>(c)] = drift->values[first] + drift->values[first + 1] + drift->values[first + 4];
  }
  TrackerSetup there = one_station(at + motion.head<3>(), turn);
  there.stations[0].body_from_tracker.rotation =
      rotation_from_vector(motion.tail<3>()) * there.stations[0].body_from_tracker.rotation;
  const auto moved = std::make_shared<const LaserTracker>("tracker", there, TrackerMeasure::cartesian);
  plan.drift = nullptr;
  const InstrumentReadings stood = moved->simulate(machine, errors, plan, options).readings;
  ASSERT_EQ(stood.count(), drifted.count());
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < stood.count(); ++k) EXPECT_NEAR(drifted.measured[c][k], stood.measured[c][k], 1e-9);
  }
}

TEST(SetupDrift, NeedsTimes) {
  EXPECT_THROW(ReadingDrift(some_drift({0, 0, 0}), std::vector<double>{}, {0, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
