#include "abbe/instruments/trackers/tracking_interferometer.h"

#include "abbe/errors/actual_pose.h"
#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

TrackingInterferometerSetup two_stations() {
  TrackingInterferometerSetup setup;
  setup.name = "tracking";
  setup.stations = {{"front", Body::workpiece, SetupPoint::open({-500, -420, 30})},
                    {"floor", Body::bed, SetupPoint::open({900, 700, -800})}};
  setup.reflectors = {{"near", Body::tool, SetupPoint::exact({10, -5, -140})},
                      {"far", Body::tool, SetupPoint::within({-80, 60, -230}, 0.05)}};
  setup.runs = {{"front/near", 0, 0, SetupNumber::open(412)},
                {"front/far", 0, 1, SetupNumber::within(380, 0.5)},
                {"floor/near", 1, 0, SetupNumber::open(950)}};
  setup.length_scale = SetupNumber::within(0.3e-6, 0.2e-6);
  return setup;
}

InstrumentReadings poses_for_items(const Machine& machine, std::size_t count, std::size_t items) {
  const PoseList poses = random_plan(machine, full_ranges(machine, 2), count, 11);
  InstrumentReadings plan;
  for (std::size_t k = 0; k < poses.count(); ++k) plan.append(poses.pose(k), k % items);
  return plan;
}

TEST(TrackingInterferometer, IndicatesTheDistanceOfStationAndReflectorWithoutTheDeadPath) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  const TrackingInterferometerSetup setup = two_stations();
  const auto tracking = std::make_shared<TrackingInterferometer>(setup);
  const InstrumentReadings readings = test::exact_readings(machine, errors, tracking, poses_for_items(machine, 30, 3));
  for (std::size_t k = 0; k < readings.count(); ++k) {
    const auto& run = setup.runs[readings.item[k]];
    const auto& station = setup.stations[run.station];
    const std::vector<double> pose = readings.poses.pose(k);
    const RigidTransform tool = station.body == Body::bed ? actual_bed_from_tool(machine, errors, pose)
                                                          : actual_workpiece_from_tool(machine, errors, pose);
    // The tool's frame stands at the functional point, the reflector counts from the gauge point.
    const Eigen::Vector3d reflector =
        tool * Eigen::Vector3d(setup.reflectors[run.reflector].offset.value() - machine.tool_offset);
    const double distance = (reflector - station.position.value()).norm();
    EXPECT_NEAR(readings.measured[0][k], (1 + 0.3e-6) * (distance - run.dead_path.value), 1e-9) << k;
  }
}

TEST(TrackingInterferometer, DerivativesEqualDifferences) {
  for (const Machine& machine :
       {test::trunnion_mill(), test::head_table_mill(), test::gantry_fork_head(), test::moving_table_cmm()}) {
    const auto tracking = std::make_shared<TrackingInterferometer>(two_stations());
    test::expect_jacobian_equals_differences(machine, test::some_errors(machine), tracking,
                                             poses_for_items(machine, 45, 3));
  }
}

TEST(TrackingInterferometer, NoiseGrowsWithTheWholeLength) {
  TrackingInterferometerSetup setup = two_stations();
  setup.noise = 2e-4;
  setup.noise_per_length = 3e-7;
  const TrackingInterferometer tracking(setup);
  InstrumentReadings readings;
  readings.append({0, 0, 0, 0, 0}, 2);
  readings.measured = {{-450}};
  EXPECT_NEAR(tracking.standard_uncertainty(readings, 0, 0), 2e-4 + 3e-7 * 500, 1e-15);
}

TEST(TrackingInterferometer, RunsWithoutStationOrReflectorAreRefused) {
  TrackingInterferometerSetup setup = two_stations();
  setup.runs[1].station = 2;
  EXPECT_THROW(TrackingInterferometer{setup}, std::invalid_argument);
  setup = two_stations();
  setup.runs[1].reflector = 7;
  EXPECT_THROW(TrackingInterferometer{setup}, std::invalid_argument);
  setup = two_stations();
  setup.reflectors[0].body = Body::bed;
  EXPECT_THROW(TrackingInterferometer{setup}, std::invalid_argument);
  setup.runs.clear();
  EXPECT_THROW(TrackingInterferometer{setup}, std::invalid_argument);
}

}  // namespace
}  // namespace abbe
