#include "abbe/verify/unseen_poses.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "abbe/instruments/aguado_for_test.h"
#include "abbe/instruments/measurement_plan.h"

namespace abbe {
namespace {

TEST(UnseenPoses, TruthAgainstTheNominalMachineIsTheInitialErrorOfAnIndependentModel) {
  const test::AguadoCase aguado = test::aguado_case();
  const TrackerReadings readings = test::aguado_readings(aguado, "aguado_5000_noise0.csv");
  // The independent model starts from the nominal point of the C axis; here that is a location error and as much of the
  // station's position.
  const Eigen::Vector3d shift = Eigen::Vector3d(700, 0, -100) - aguado.machine.axes[0].point;
  ErrorSet nominal;
  nominal.locations = {{0, Component::X, shift.x(), 0}, {0, Component::Y, shift.y(), 0}};
  TrackerSetup setup = aguado.setup;
  setup.stations[0].body_from_tracker.translation += shift;
  double sum = 0, largest = 0;
  for (std::uint16_t r = 0; r < 3; ++r) {
    PoseList poses;
    for (std::size_t k = 0; k < readings.count(); ++k) {
      if (readings.reflector[k] == r) poses.append(readings.poses.pose(k));
    }
    const SampleStatistics s =
        compare_predictions(aguado.machine, {&aguado.truth, &aguado.setup}, {&nominal, &setup}, poses, {{0, r}});
    EXPECT_EQ(s.excluded, 0u);
    sum += s.mean * static_cast<double>(s.count) / 5000;
    largest = std::max(largest, s.maximum);
  }
  EXPECT_NEAR(1e3 * sum, aguado.json["expected_n5000_noise0"]["initial_mean_um"].get<double>(), 1e-3);
  EXPECT_NEAR(1e3 * largest, aguado.json["expected_n5000_noise0"]["initial_max_um"].get<double>(), 1e-3);
}

TEST(UnseenPoses, StatesThatDifferOnlyByTheGaugePredictTheSame) {
  const test::AguadoCase aguado = test::aguado_case();
  // A first harmonic of EXC and EYC that turns with the table is a shift of the station on it.
  ErrorSet harmonic = aguado.truth;
  for (ErrorMotion& motion : harmonic.motions) {
    if (motion.axis == 0) std::fill(motion.coefficients.begin(), motion.coefficients.end(), 0.0);
  }
  const ErrorSet plain = harmonic;
  const Eigen::Vector3d v(0.4, -0.3, 0);
  harmonic.motions[0].coefficients[1] = v.x();
  harmonic.motions[0].coefficients[2] = v.y();
  harmonic.motions[1].coefficients[1] = v.y();
  harmonic.motions[1].coefficients[2] = -v.x();
  TrackerSetup moved = aguado.setup;
  moved.stations[0].body_from_tracker.translation += v;
  const PoseList poses = random_plan(aguado.machine, full_ranges(aguado.machine, 2), 500, 5);
  const std::vector<Sight> sights{{0, 0}, {0, 1}, {0, 2}};
  const TrackerState a{&harmonic, &aguado.setup}, b{&plain, &moved}, c{&plain, &aguado.setup};
  const SampleStatistics same = compare_predictions(aguado.machine, a, b, poses, sights);
  EXPECT_EQ(same.count, 1500u);
  EXPECT_LT(same.maximum, 1e-10);
  EXPECT_NEAR(compare_predictions(aguado.machine, a, c, poses, sights).mean, 0.5, 1e-9);
}

TEST(UnseenPoses, PredictionsOutsideTheMeasuredRangeAreExcluded) {
  const test::AguadoCase aguado = test::aguado_case();
  PoseList poses = random_plan(aguado.machine, full_ranges(aguado.machine, 2), 10, 5);
  poses.axis[1][4] = 1500;
  const TrackerState state{&aguado.truth, &aguado.setup};
  const SampleStatistics s = compare_predictions(aguado.machine, state, state, poses, {{0, 0}});
  EXPECT_EQ(s.excluded, 1u);
  EXPECT_EQ(s.maximum, 0);
  TrackerSetup other = aguado.setup;
  other.reflectors.pop_back();
  EXPECT_THROW(compare_predictions(aguado.machine, state, {&aguado.truth, &other}, poses, {{0, 0}}),
               std::invalid_argument);
}

}  // namespace
}  // namespace abbe
