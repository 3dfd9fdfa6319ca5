#include "abbe/instruments/trackers/tracker_offset_start.h"

#include <gtest/gtest.h>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

/// A tracker on the table of a five-axis machine and two reflectors on its spindle, of which the first is open.
TrackerSetup open_setup() {
  TrackerSetup setup;
  setup.stations.resize(1);
  setup.stations[0].body_from_tracker = {rotation_from_vector({0.2, -0.1, 1}), {400, -250, 100}};
  setup.stations[0].noise = TrackerNoise::isotropic(10, 0);
  setup.reflectors = {{.name = "open", .offset = {20, -30, -140}, .estimate_offset = true},
                      {.name = "fixed", .offset = {-60, 10, -90}}};
  return setup;
}

InstrumentReadings readings_of(const Machine& machine, const TrackerSetup& setup, std::size_t poses,
                               bool turns = true) {
  const auto tracker = std::make_shared<LaserTracker>("tracker", setup, TrackerMeasure::cartesian);
  InstrumentReadings plan;
  std::vector<AxisRange> ranges = full_ranges(machine, 2);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    if (!turns && machine.axes[i].kind == AxisKind::rotary) ranges[i] = AxisRange::fixed(0);
  }
  const PoseList list = random_plan(machine, ranges, poses, 8);
  for (std::size_t k = 0; k < list.count(); ++k) {
    for (std::size_t item = 0; item < tracker->items().size(); ++item) plan.append(list.pose(k), item);
  }
  return test::exact_readings(machine, test::some_errors(machine), tracker, plan);
}

TEST(TrackerOffsetStart, FindsOpenOffsetsThatAreFarOff) {
  const Machine machine = test::trunnion_mill();
  const TrackerSetup truth = open_setup();
  for (const std::size_t poses : {4U, 6U, 40U}) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      InstrumentReadings readings = readings_of(machine, truth, poses);
      RandomStream random(7, seed);
      // A third of many readings is wrong.
      for (std::size_t k = 0; poses > 10 && k < readings.count(); k += 3) readings.measured[k % 2][k] += 300;
      TrackerSetup stated = truth;
      stated.reflectors[0].offset +=
          random.uniform(20, 300) * Vector3d(random.normal(), random.normal(), 1).normalized();
      const LaserTracker tracker("tracker", stated, TrackerMeasure::cartesian);
      const TrackerStart start = find_poses_and_offsets(machine, tracker, readings, stated);
      ASSERT_TRUE(start.determined());
      EXPECT_LT((stated.reflectors[0].offset - truth.reflectors[0].offset).norm(), 2) << poses << " " << seed;
      EXPECT_EQ(stated.reflectors[1].offset, truth.reflectors[1].offset);
      EXPECT_LT(
          (start.stations[0].body_from_tracker.translation - truth.stations[0].body_from_tracker.translation).norm(),
          5);
    }
  }
}

TEST(TrackerOffsetStart, LeavesOffsetsAsStatedThatExplainTheReadingsOrAreKnown) {
  const Machine machine = test::trunnion_mill();
  const TrackerSetup truth = open_setup();
  const InstrumentReadings readings = readings_of(machine, truth, 30);
  TrackerSetup stated = truth;
  stated.reflectors[0].offset += Vector3d(0.5, -1, 0.3);
  TrackerSetup setup = stated;
  find_poses_and_offsets(machine, LaserTracker("tracker", setup, TrackerMeasure::cartesian), readings, setup);
  EXPECT_EQ(setup.reflectors[0].offset, stated.reflectors[0].offset);
  stated.reflectors[0].offset.x() += 80;
  stated.reflectors[0].offset_standard_uncertainty = {0.1, 0.1, 0.1};
  setup = stated;
  find_poses_and_offsets(machine, LaserTracker("tracker", setup, TrackerMeasure::cartesian), readings, setup);
  EXPECT_EQ(setup.reflectors[0].offset, stated.reflectors[0].offset);
}

TEST(TrackerOffsetStart, WhatReadingsDoNotDetermineOfAnOffsetStaysAsStated) {
  // Without a turn of a rotary axis an offset that all reflectors have is one of the station.
  const Machine machine = test::trunnion_mill();
  TrackerSetup truth = open_setup();
  truth.reflectors.pop_back();
  const InstrumentReadings readings = readings_of(machine, truth, 30, false);
  TrackerSetup stated = truth;
  stated.reflectors[0].offset.x() += 80;
  const LaserTracker tracker("tracker", stated, TrackerMeasure::cartesian);
  const TrackerStart start = find_poses_and_offsets(machine, tracker, readings, stated);
  EXPECT_TRUE(start.determined());
  EXPECT_NEAR(stated.reflectors[0].offset.x(), truth.reflectors[0].offset.x() + 80, 1e-9);
}

TEST(TrackerOffsetStart, NothingIsFoundInNoise) {
  const Machine machine = test::trunnion_mill();
  const TrackerSetup truth = open_setup();
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    InstrumentReadings readings = readings_of(machine, truth, 20);
    RandomStream random(9, seed);
    for (std::vector<double>& component : readings.measured) {
      for (double& value : component) value = random.uniform(-500, 500);
    }
    TrackerSetup setup = truth;
    const TrackerStart start =
        find_poses_and_offsets(machine, LaserTracker("tracker", setup, TrackerMeasure::cartesian), readings, setup);
    EXPECT_FALSE(start.determined()) << seed;
    EXPECT_EQ(setup.reflectors[0].offset, truth.reflectors[0].offset);
  }
}

}  // namespace
}  // namespace abbe
