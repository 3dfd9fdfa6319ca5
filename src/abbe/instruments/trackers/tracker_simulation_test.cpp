#include "abbe/instruments/trackers/tracker_simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "abbe/instruments/aguado_for_test.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/instruments/trackers/tracker_observations.h"
#include "abbe/instruments/trackers/tracker_start.h"

namespace abbe {
namespace {

using test::AguadoCase;

PoseList poses_of(const AguadoCase& aguado, std::size_t count) {
  return random_plan(aguado.machine, full_ranges(aguado.machine, 2), count, 11);
}

TEST(TrackerSimulation, WithoutNoiseGivesTheReadingsOfAnIndependentModel) {
  const AguadoCase aguado = test::aguado_case();
  const TrackerReadings golden = test::aguado_readings(aguado, "aguado_500_noise0.csv");
  TrackerSimulationOptions options;
  options.noise_factor = 0;
  const SimulatedTracker simulated =
      simulate_tracker(aguado.machine, aguado.truth, aguado.setup, golden.poses, options);
  ASSERT_EQ(simulated.readings.count(), 1500u);
  for (std::size_t k = 0; k < 500; ++k) {
    const std::size_t reading = 3 * k + golden.reflector[k];
    EXPECT_LT((simulated.readings.point(reading) - golden.point(k)).norm(), 1e-8);
  }
}

class SimulatedNoise : public testing::TestWithParam<TrackerMeasure> {};

TEST_P(SimulatedNoise, HasTheStatedStandardUncertainty) {
  AguadoCase aguado = test::aguado_case();
  aguado.setup.stations[0].noise = {.range_um = 3, .range_um_per_m = 1, .transverse_um = 15, .transverse_um_per_m = 6};
  TrackerSimulationOptions options;
  options.measure = GetParam();
  const SimulatedTracker simulated =
      simulate_tracker(aguado.machine, aguado.truth, aguado.setup, poses_of(aguado, 4000), options);
  const std::size_t n = simulated.readings.count();
  ASSERT_EQ(n, 12000u);
  const TrackerObservations observations(aguado.machine, aguado.truth, aguado.setup, simulated.readings);
  double squares[3] = {}, fourth = 0;
  std::vector<double> r(3 * 128);
  for (std::size_t first = 0; first < n; first += 128) {
    const std::size_t count = std::min<std::size_t>(128, n - first);
    observations.evaluate(first, count, {}, {}, r.data(), nullptr, 0);
    for (std::size_t i = 0; i < 3 * count; ++i) {
      squares[i / count] += r[i] * r[i];
      fourth += std::pow(r[i], 4);
    }
  }
  // Standard deviation of a mean of 12,000 squares: 0.013.
  for (double sum : squares) EXPECT_NEAR(sum / static_cast<double>(n), 1, 0.05);
  EXPECT_NEAR(fourth / static_cast<double>(3 * n), 3, 0.25);
}
INSTANTIATE_TEST_SUITE_P(BothMeasures, SimulatedNoise,
                         testing::Values(TrackerMeasure::cartesian, TrackerMeasure::range_and_angles));

TEST(TrackerSimulation, SameSeedSameBytesWithAnyNumberOfThreads) {
  const AguadoCase aguado = test::aguado_case();
  TrackerSimulationOptions options;
  options.choice = SightChoice::random;
  options.outlier_fraction = 0.1;
  options.threads = 1;
  std::size_t last = 0;
  options.progress = [&last](std::size_t done, std::size_t total) {
    EXPECT_GT(done, last);
    EXPECT_LE(done, total);
    last = done;
  };
  const PoseList poses = poses_of(aguado, 2000);
  const SimulatedTracker one = simulate_tracker(aguado.machine, aguado.truth, aguado.setup, poses, options);
  EXPECT_EQ(last, 2000u);
  options.progress = nullptr;
  options.threads = 3;
  const SimulatedTracker three = simulate_tracker(aguado.machine, aguado.truth, aguado.setup, poses, options);
  EXPECT_EQ(one.readings.measured, three.readings.measured);
  EXPECT_EQ(one.readings.reflector, three.readings.reflector);
  options.seed = 2;
  const SimulatedTracker other = simulate_tracker(aguado.machine, aguado.truth, aguado.setup, poses, options);
  EXPECT_NE(one.readings.measured, other.readings.measured);
}

TEST(TrackerSimulation, OutliersAndSwappedReflectorsAreAsManyAndAsLargeAsStated) {
  const AguadoCase aguado = test::aguado_case();
  TrackerSimulationOptions options;
  options.outlier_fraction = 0.3;
  options.outlier_mm = 2;
  const PoseList poses = poses_of(aguado, 1000);
  const SimulatedTracker simulated = simulate_tracker(aguado.machine, aguado.truth, aguado.setup, poses, options);
  EXPECT_NEAR(static_cast<double>(simulated.outliers.size()), 900, 100);
  const TrackerObservations observations(aguado.machine, aguado.truth, aguado.setup, simulated.readings);
  double mean = 0;
  for (std::uint32_t k : simulated.outliers) mean += observations.distance(k).norm();
  EXPECT_NEAR(mean / static_cast<double>(simulated.outliers.size()), 2, 0.1);

  options.outlier_fraction = 0;
  options.swapped_fraction = 0.02;
  const SimulatedTracker swapped = simulate_tracker(aguado.machine, aguado.truth, aguado.setup, poses, options);
  EXPECT_NEAR(static_cast<double>(swapped.swapped.size()), 60, 30);
  const TrackerStart start = find_station_poses(aguado.machine, ErrorSet(), aguado.setup, swapped.readings);
  std::vector<std::uint32_t> found;
  for (const SwappedReflector& run : start.swapped) {
    for (std::size_t k = run.first; k <= run.last; ++k) found.push_back(static_cast<std::uint32_t>(k));
  }
  EXPECT_EQ(found, swapped.swapped);
}

TEST(TrackerSimulation, LeavesOutWhatTheReflectorCannotSee) {
  AguadoCase aguado = test::aguado_case();
  aguado.setup.reflectors.resize(1);
  aguado.setup.reflectors[0].view_direction = Eigen::Vector3d::UnitX();
  aguado.setup.reflectors[0].view_half_angle = 60 * std::numbers::pi / 180;
  const PoseList poses = poses_of(aguado, 500);
  const TrackerSimulationOptions options;
  const SimulatedTracker simulated = simulate_tracker(aguado.machine, ErrorSet(), aguado.setup, poses, options);
  EXPECT_EQ(simulated.hidden + simulated.readings.count(), 500u);
  std::size_t expected = 0;
  for (std::size_t k = 0; k < 500; ++k) {
    // The station seen from the tool, by the nominal chain.
    const std::vector<double> positions = poses.pose(k);
    const Eigen::Vector3d station = (nominal_bed_from_tool(aguado.machine, positions).inverse() *
                                     nominal_bed_from_workpiece(aguado.machine, positions)) *
                                    aguado.setup.stations[0].body_from_tracker.translation;
    expected += (station - aguado.setup.reflectors[0].offset).normalized().x() >= 0.5;
  }
  EXPECT_EQ(simulated.readings.count(), expected);
  EXPECT_GT(expected, 50u);
  EXPECT_LT(expected, 450u);
}

TEST(TrackerSimulation, RefusesASightWithinOneBody) {
  AguadoCase aguado = test::aguado_case();
  aguado.setup.stations[0].body = Body::tool;
  EXPECT_THROW(simulate_tracker(aguado.machine, ErrorSet(), aguado.setup, poses_of(aguado, 5), {}),
               std::invalid_argument);
}

}  // namespace
}  // namespace abbe
