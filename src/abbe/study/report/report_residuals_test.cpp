#include "abbe/study/report/report_residuals.h"

#include <gtest/gtest.h>

#include "abbe/instruments/trackers/tracker_observations.h"

namespace abbe {
namespace {

/// A spindle moving along X before a tracker on the bed, and one reading 3, -4, 12 um off in the tracker's frame.
TrackerObservations one_reading(TrackerMeasure measure) {
  Machine machine;
  machine.axes = {{.name = "X", .kind = AxisKind::linear, .side = ChainSide::tool}};
  machine.axes[0].direction = Eigen::Vector3d::UnitX();
  machine.axes[0].travel_max = 500;
  TrackerSetup setup;
  setup.stations.resize(1);
  setup.stations[0].body = Body::bed;
  setup.stations[0].noise = TrackerNoise::isotropic(10, 0);
  setup.reflectors.resize(1);
  setup.reflectors[0].offset = {300, 400, 1200};
  TrackerReadings readings;
  readings.measure = measure;
  readings.reserve(1, 1);
  const std::vector<double> position{0};
  readings.poses.append(position);
  readings.station = {0};
  readings.reflector = {0};
  const Eigen::Vector3d off(3e-3, -4e-3, 12e-3), point = setup.reflectors[0].offset + off;
  const Eigen::Vector3d stated = measure == TrackerMeasure::cartesian ? point : range_and_angles_from_point(point);
  for (std::size_t k = 0; k < 3; ++k) readings.measured[k].push_back(stated[static_cast<int>(k)]);
  return {machine, ErrorSet(), setup, readings};
}

TEST(TrackerComponents, OfCoordinatesAreThoseOfTheTrackerFrame) {
  const TrackerObservations observations = one_reading(TrackerMeasure::cartesian);
  const std::vector<ResidualComponent> components = residual_components(observations);
  ASSERT_EQ(components.size(), 3u);
  const char* names[] = {"x", "y", "z"};
  const double off_um[] = {3, -4, 12};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(components[k].name, names[k]);
    EXPECT_EQ(components[k].unit, "um");
    EXPECT_NEAR(components[k].residual.at(0), off_um[k], 1e-6);
    EXPECT_NEAR(components[k].normalised.at(0), off_um[k] / 10, 1e-7);
  }
}

TEST(TrackerComponents, OfRangeAndAnglesLieAlongAndAcrossTheBeam) {
  const TrackerObservations observations = one_reading(TrackerMeasure::range_and_angles);
  const std::vector<ResidualComponent> components = residual_components(observations);
  ASSERT_EQ(components.size(), 3u);
  // Beam along (3, 4, 12) / 13; across it (-4, 3, 0) / 5 and (-36, -48, 25) / 65.
  const double off_um[] = {(3 * 3 - 4 * 4 + 12 * 12) / 13.0, (-4 * 3 - 3 * 4) / 5.0,
                           (-36 * 3 + 48 * 4 + 25 * 12) / 65.0};
  const char* names[] = {"range", "azimuth", "elevation"};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(components[k].name, names[k]);
    EXPECT_NEAR(components[k].residual.at(0), off_um[k], 1e-3);
    EXPECT_NEAR(components[k].normalised.at(0), off_um[k] / 10, 1e-4);
  }
}

}  // namespace
}  // namespace abbe
