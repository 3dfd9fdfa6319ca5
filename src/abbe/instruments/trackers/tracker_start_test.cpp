#include "abbe/instruments/trackers/tracker_start.h"

#include <gtest/gtest.h>

#include "abbe/instruments/aguado_for_test.h"

namespace abbe {
namespace {

using test::AguadoCase;

double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return rotation_vector(a * b.transpose()).norm();
}

TEST(TrackerStart, FindsThePoseFromTheNominalMachineWithNothingKnown) {
  AguadoCase aguado = test::aguado_case();
  const RigidTransform truth = aguado.setup.stations[0].body_from_tracker;
  aguado.setup.stations[0].body_from_tracker = {rotation_from_vector({2, -1, 1}), {5000, -3000, 100}};
  const TrackerReadings readings = test::aguado_readings(aguado, "aguado_500_noiseLT.csv");
  const TrackerStart start = find_station_poses(aguado.machine, ErrorSet(), aguado.setup, readings);
  ASSERT_TRUE(start.determined());
  // The machine's errors are half a millimetre: no better pose is to be had from the nominal machine.
  EXPECT_LT((start.stations[0].body_from_tracker.translation - truth.translation).norm(), 1.5);
  EXPECT_LT(angle_between(start.stations[0].body_from_tracker.rotation, truth.rotation), 1e-3);
  EXPECT_LT(start.stations[0].rms_mm, 1.0);
  EXPECT_TRUE(start.swapped.empty());
  EXPECT_TRUE(start.messages.empty());
}

TEST(TrackerStart, WithTheTrueErrorsThePoseIsExact) {
  const AguadoCase aguado = test::aguado_case();
  const TrackerReadings readings = test::aguado_readings(aguado, "aguado_500_noise0.csv");
  const TrackerStart start = find_station_poses(aguado.machine, aguado.truth, aguado.setup, readings);
  const RigidTransform& truth = aguado.setup.stations[0].body_from_tracker;
  EXPECT_LT((start.stations[0].body_from_tracker.translation - truth.translation).norm(), 1e-7);
  EXPECT_LT(start.stations[0].rms_mm, 1e-8);
}

TEST(TrackerStart, NamesRunsOfReadingsTakenOnAnotherReflector) {
  AguadoCase aguado = test::aguado_case();
  TrackerReadings readings = test::aguado_readings(aguado, "aguado_500_noiseLT.csv");
  // The first thirty readings of reflector 2 are booked as reflector 1.
  std::size_t changed = 0;
  std::vector<std::size_t> expected;
  for (std::size_t k = 0; k < readings.count() && changed < 30; ++k) {
    if (readings.reflector[k] != 1) continue;
    readings.reflector[k] = 0;
    expected.push_back(k);
    ++changed;
  }
  const TrackerStart start = find_station_poses(aguado.machine, ErrorSet(), aguado.setup, readings);
  std::vector<std::size_t> found;
  for (const SwappedReflector& run : start.swapped) {
    EXPECT_EQ(run.stated, 0u);
    EXPECT_EQ(run.better, 1u);
    EXPECT_GT(run.stated_mm, 50 * run.better_mm);
    for (std::size_t k = run.first; k <= run.last; ++k) found.push_back(k);
  }
  EXPECT_EQ(found, expected);
  ASSERT_FALSE(start.messages.empty());
  EXPECT_NE(start.messages[0].find("reflector2 fits better than reflector1"), std::string::npos) << start.messages[0];
}

TEST(TrackerStart, SurvivesThirtyPercentGrossOutliers) {
  AguadoCase aguado = test::aguado_case();
  TrackerReadings readings = test::aguado_readings(aguado, "aguado_500_noiseLT.csv");
  for (std::size_t k = 0; k < readings.count(); k += 3) readings.measured[k % 2][k] += 400;
  const TrackerStart start = find_station_poses(aguado.machine, ErrorSet(), aguado.setup, readings);
  const RigidTransform& truth = aguado.setup.stations[0].body_from_tracker;
  ASSERT_TRUE(start.determined());
  EXPECT_LT((start.stations[0].body_from_tracker.translation - truth.translation).norm(), 1.5);
  EXPECT_GE(start.stations[0].outliers, 167u);
}

TEST(TrackerStart, SaysWhichRotationReadingsOnALineLeaveOpen) {
  AguadoCase aguado = test::aguado_case();
  TrackerReadings readings;
  readings.reserve(3, 10);
  const TrackerReadings all = test::aguado_readings(aguado, "aguado_500_noise0.csv");
  // One axis moves: the reflector runs along the machine's Z, which is the workpiece's.
  for (int i = 0; i < 10; ++i) {
    readings.poses.append({0, 500, 60.0 * i});
    readings.station.push_back(0);
    readings.reflector.push_back(0);
    const Eigen::Vector3d p =
        aguado.setup.stations[0].body_from_tracker.inverse() * Eigen::Vector3d(100, 200, 60.0 * i);
    for (std::size_t k = 0; k < 3; ++k) readings.measured[k].push_back(p[static_cast<int>(k)]);
  }
  const TrackerStart start = find_station_poses(aguado.machine, ErrorSet(), aguado.setup, readings);
  EXPECT_FALSE(start.determined());
  EXPECT_EQ(start.stations[0].status, BestFitStatus::collinear);
  EXPECT_NE(start.stations[0].note.find("0.000, 0.000, "), std::string::npos) << start.stations[0].note;
  EXPECT_NE(start.stations[0].note.find("1.000) of the workpiece"), std::string::npos) << start.stations[0].note;
}

TEST(TrackerStart, AdmitsThatAllReadingsAtOnePoseDetermineNothing) {
  AguadoCase aguado = test::aguado_case();
  TrackerReadings readings;
  readings.reserve(3, 10);
  for (int i = 0; i < 10; ++i) {
    readings.poses.append({0, 500, 60.0});
    readings.station.push_back(0);
    readings.reflector.push_back(0);
    for (std::size_t k = 0; k < 3; ++k) readings.measured[k].push_back(100.0 + 0.01 * (i % 3));
  }
  TrackerSetup setup = aguado.setup;
  const TrackerStart start = find_station_poses(aguado.machine, ErrorSet(), setup, readings);
  EXPECT_FALSE(start.determined());
  apply(start, setup);
  EXPECT_EQ(setup.stations[0].body_from_tracker.translation, aguado.setup.stations[0].body_from_tracker.translation);
}

}  // namespace
}  // namespace abbe
