#include "abbe/instruments/trackers/tracking_interferometer_start.h"

#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

/// Three stations about the table of the three-axis machine, two reflectors, a run of each pair.
TrackingInterferometerSetup true_setup() {
  TrackingInterferometerSetup setup;
  setup.stations = {{"left", Body::workpiece, SetupPoint::open({-500, -60, 40})},
                    {"right", Body::workpiece, SetupPoint::open({620, 300, 30})},
                    {"high", Body::workpiece, SetupPoint::open({-350, 380, 500})}};
  setup.reflectors = {{"short", Body::tool, SetupPoint::exact({0, 0, -150})},
                      {"long", Body::tool, SetupPoint::exact({100, -50, -250})}};
  for (std::size_t s = 0; s < 3; ++s) {
    for (std::size_t r = 0; r < 2; ++r) {
      const double dead_path = 300 + 50 * static_cast<double>(s) + 20 * static_cast<double>(r);
      setup.runs.push_back(
          {setup.stations[s].name + "/" + setup.reflectors[r].name, s, r, SetupNumber::open(dead_path)});
    }
  }
  setup.noise = 0.3e-3;
  return setup;
}

/// What is known beforehand: nothing of positions and dead paths.
TrackingInterferometerSetup unknown(TrackingInterferometerSetup setup, const Vector3d& guess = Vector3d::Zero()) {
  for (auto& station : setup.stations) station.position = SetupPoint::open(guess);
  for (auto& run : setup.runs) run.dead_path = SetupNumber::open(0);
  return setup;
}

/// A grid with every run. @param flat  Z stays where it is
InstrumentReadings grid(const Machine& machine, std::size_t runs, bool flat = false) {
  std::vector<AxisRange> ranges = full_ranges(machine, 4);
  if (flat) ranges[machine.find_axis("Z")] = AxisRange::fixed(-200);
  const PoseList poses = grid_plan(machine, ranges);
  InstrumentReadings plan;
  for (std::size_t run = 0; run < runs; ++run) {
    for (std::size_t k = 0; k < poses.count(); ++k) plan.append(poses.pose(k), run);
  }
  return plan;
}

TEST(TrackingStart, FindsStationsAndDeadPathsOfAMachineWithErrorsFromTheLengthsAlone) {
  const Machine machine = test::three_axis_mill();
  const TrackingInterferometerSetup truth = true_setup();
  const auto actual = std::make_shared<TrackingInterferometer>(truth);
  const InstrumentReadings plan = grid(machine, truth.runs.size());
  ErrorSet errors;
  for (const double size : {0.0, 1.0}) {
    if (size > 0) errors = test::some_errors(machine);
    InstrumentReadings readings = test::exact_readings(machine, errors, actual, plan);
    for (std::size_t k = 0; k < readings.count(); k += 7) readings.measured[0][k] += k % 2 == 0 ? 12 : -3;
    const TrackingInterferometer tracking(unknown(truth));
    const TrackingStart start = find_tracking_start(machine, ErrorSet{}, tracking, readings);
    EXPECT_TRUE(start.determined());
    EXPECT_TRUE(start.messages.empty());
    for (std::size_t s = 0; s < 3; ++s) {
      EXPECT_LT((start.stations[s].position - truth.stations[s].position.value()).norm(), size > 0 ? 3 : 1e-5) << s;
      EXPECT_GE(start.stations[s].outliers, plan.count() / 3 / 7);
    }
    std::vector<std::string> notes;
    const std::vector<double> values = tracking.start_values(machine, readings, notes);
    EXPECT_EQ(values, start.values);
    for (std::size_t q = 0; q < values.size(); ++q) {
      EXPECT_NEAR(values[q], actual->quantities()[q].value, size > 0 ? 3 : 1e-5) << actual->quantities()[q].name;
    }
  }
}

TEST(TrackingStart, KeepsWhatIsKnown) {
  const Machine machine = test::three_axis_mill();
  TrackingInterferometerSetup truth = true_setup();
  const auto actual = std::make_shared<TrackingInterferometer>(truth);
  const InstrumentReadings readings =
      test::exact_readings(machine, ErrorSet{}, actual, grid(machine, truth.runs.size()));
  TrackingInterferometerSetup given = unknown(truth);
  given.stations[1].position = SetupPoint::within(truth.stations[1].position.value(), 0.1);
  given.runs[0].dead_path = SetupNumber::exact(300);
  const TrackingInterferometer tracking(given);
  const TrackingStart start = find_tracking_start(machine, ErrorSet{}, tracking, readings);
  EXPECT_EQ(start.stations[1].status, TrilaterationStatus::not_run);
  EXPECT_EQ(start.stations[0].status, TrilaterationStatus::ok);
  for (std::size_t q = 0; q < start.values.size(); ++q) {
    EXPECT_NEAR(start.values[q], actual->quantities()[q].value, 1e-5) << actual->quantities()[q].name;
  }
}

TEST(TrackingStart, PointsInAPlaneLeaveTheSideOpenAndThatIsSaid) {
  const Machine machine = test::three_axis_mill();
  TrackingInterferometerSetup truth = true_setup();
  truth.runs.erase(truth.runs.begin() + 1, truth.runs.end());  // one reflector, one station
  const auto actual = std::make_shared<TrackingInterferometer>(truth);
  const InstrumentReadings readings = test::exact_readings(machine, ErrorSet{}, actual, grid(machine, 1, true));
  // Plane of the reflector: above the station. A guess below it gives the true one, above it the mirrored one.
  for (const double guess : {-100.0, 900.0}) {
    const TrackingInterferometer tracking(unknown(truth, {0, 0, guess}));
    const TrackingStart start = find_tracking_start(machine, ErrorSet{}, tracking, readings);
    EXPECT_FALSE(start.determined());
    EXPECT_EQ(start.stations[0].status, TrilaterationStatus::mirrored);
    const Vector3d& right = guess < 0 ? start.stations[0].position : start.stations[0].other;
    EXPECT_LT((right - truth.stations[0].position.value()).norm(), 1e-4);
    ASSERT_EQ(start.messages.size(), 1u);
    EXPECT_NE(start.messages[0].find("left: all points lie near one plane (normal (0.000, 0.000, "), std::string::npos)
        << start.messages[0];
    EXPECT_NE(start.messages[0].find("explain the lengths equally well"), std::string::npos);
  }
}

TEST(TrackingStart, SaysWhatALineDoesNotDetermine) {
  const Machine machine = test::three_axis_mill();
  TrackingInterferometerSetup truth = true_setup();
  truth.runs.erase(truth.runs.begin() + 1, truth.runs.end());
  const auto actual = std::make_shared<TrackingInterferometer>(truth);
  InstrumentReadings plan;
  for (const double x : evenly_spaced(0, 760, 20)) plan.append({x, 100, -100}, 0);
  const InstrumentReadings readings = test::exact_readings(machine, ErrorSet{}, actual, plan);
  const TrackingStart start =
      find_tracking_start(machine, ErrorSet{}, TrackingInterferometer(unknown(truth, {1, 2, 3})), readings);
  EXPECT_EQ(start.stations[0].status, TrilaterationStatus::collinear);
  EXPECT_EQ(start.stations[0].position, Vector3d(1, 2, 3));
  ASSERT_EQ(start.messages.size(), 1u);
  EXPECT_NE(start.messages[0].find("left: all points lie on one line"), std::string::npos);
}

}  // namespace
}  // namespace abbe
