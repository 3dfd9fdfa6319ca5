#include "abbe/instruments/trackers/laser_tracker.h"

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/aguado_for_test.h"
#include "abbe/instruments/instrument_for_test.h"

namespace abbe {
namespace {

/// Two stations of which one is turned and estimated, and reflectors with an offset that is known, open, or known
/// within an uncertainty.
std::shared_ptr<const LaserTracker> two_stations(const test::AguadoCase& aguado, TrackerMeasure measure,
                                                 StatedUncertainty stated = StatedUncertainty::none) {
  TrackerSetup setup = aguado.setup;
  setup.stations.push_back(setup.stations.front());
  setup.stations[1].name = "tracker2";
  setup.stations[1].body_from_tracker.translation += Eigen::Vector3d(-300, 800, 150);
  setup.stations[0].estimate_pose = false;
  setup.reflectors[1].estimate_offset = true;
  setup.reflectors[2].estimate_offset = true;
  setup.reflectors[2].offset_standard_uncertainty = {0.01, 0.02, 0.03};
  const LaserTracker given("tracker", setup, measure, stated);
  std::vector<double> values;
  for (const SetupQuantity& quantity : given.quantities()) values.push_back(quantity.value);
  for (std::size_t k = 9; k < 12; ++k) values[k] = 0.2 * static_cast<double>(k) - 2;  // a turn on top of the given one
  return std::dynamic_pointer_cast<const LaserTracker>(given.with_values(values));
}

InstrumentReadings plan_of_all(const Machine& machine, const Instrument& device, std::size_t poses) {
  InstrumentReadings plan;
  const PoseList list = random_plan(machine, full_ranges(machine, 2), poses, 4);
  for (std::size_t k = 0; k < list.count(); ++k) {
    for (std::size_t item = 0; item < device.items().size(); ++item) plan.append(list.pose(k), item);
  }
  return plan;
}

class LaserTrackerOf : public testing::TestWithParam<TrackerMeasure> {};

TEST_P(LaserTrackerOf, EquationHasTheDerivativesOfFiniteDifferences) {
  const test::AguadoCase aguado = test::aguado_case();
  const auto device = two_stations(aguado, GetParam());
  test::expect_jacobian_equals_differences(aguado.machine, aguado.truth, device,
                                           plan_of_all(aguado.machine, *device, 12), 2e-6);
}

TEST_P(LaserTrackerOf, ObservationsAndEquationAreTheSameModel) {
  const test::AguadoCase aguado = test::aguado_case();
  const auto device = two_stations(aguado, GetParam());
  const InstrumentReadings exact =
      test::exact_readings(aguado.machine, aguado.truth, device, plan_of_all(aguado.machine, *device, 50));
  const auto observations = device->observations(aguado.machine, aguado.truth, exact);
  ASSERT_EQ(observations->unknowns().size(), 12U);
  for (std::size_t k = 0; k < exact.count(); ++k) {
    for (const double apart : observations->deviation(k)) ASSERT_NEAR(apart, 0, 1e-9) << k;
    ASSERT_NEAR(*observations->length_of_deviation(k), 0, 1e-9);
  }
  // In um, whatever the noise is.
  InstrumentReadings off = exact;
  for (double& value : off.measured[0]) value += 0.003;
  const auto in_um = device->observations_in_um(aguado.machine, aguado.truth, off);
  std::vector<double> residuals(3);
  in_um->evaluate(5, 1, {}, {}, residuals.data(), nullptr, 0);
  EXPECT_NEAR(std::hypot(residuals[0], residuals[1], residuals[2]), 3, 1e-6);
}

TEST_P(LaserTrackerOf, KnowsWhatTheDataStateOfTheirUncertainty) {
  const test::AguadoCase aguado = test::aguado_case();
  InstrumentSimulationOptions options;
  options.readings_per_pose = 6;
  for (const StatedUncertainty stated :
       {StatedUncertainty::none, StatedUncertainty::standard, StatedUncertainty::covariance}) {
    const auto device = two_stations(aguado, GetParam(), stated);
    const InstrumentReadings readings =
        device->simulate(aguado.machine, aguado.truth, plan_of_all(aguado.machine, *device, 20), options).readings;
    EXPECT_EQ(readings.count(), 120U);
    EXPECT_EQ(readings.uncertainty.size(), stated == StatedUncertainty::standard ? 3U : 0U);
    EXPECT_EQ(readings.covariance.size(), stated == StatedUncertainty::covariance ? 6U : 0U);
    const TrackerReadings own = device->tracker_readings(readings);
    EXPECT_EQ(own.stated, stated);
    EXPECT_EQ(own.uncertainty[5].size(), stated == StatedUncertainty::covariance ? 120U : 0U);
    const InstrumentReadings back = device->instrument_readings(own);
    EXPECT_EQ(back.item, readings.item);
    EXPECT_EQ(back.measured, readings.measured);
    EXPECT_EQ(back.covariance, readings.covariance);
    EXPECT_EQ(readings.subset({7, 3}).covariance.size(), readings.covariance.size());
    // What is stated is what the noise model says, component by component.
    for (std::size_t c = 0; c < 3 && stated == StatedUncertainty::standard; ++c) {
      EXPECT_NEAR(readings.uncertainty[c][11] / device->standard_uncertainty(readings, 11, c), 1, 1e-12) << c;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, LaserTrackerOf,
                         testing::Values(TrackerMeasure::cartesian, TrackerMeasure::range_and_angles));

TEST(LaserTracker, FindsItsStationsAndKeepsWhatIsGiven) {
  const test::AguadoCase aguado = test::aguado_case();
  const auto truth = two_stations(aguado, TrackerMeasure::cartesian);
  const InstrumentReadings exact =
      test::exact_readings(aguado.machine, ErrorSet{}, truth, plan_of_all(aguado.machine, *truth, 50));
  TrackerSetup unknown = truth->setup();
  unknown.stations[1].body_from_tracker = {};
  unknown.stations[1].pose_is_known = false;
  const auto device = std::make_shared<LaserTracker>("tracker", unknown, TrackerMeasure::cartesian);
  const StartedInstrument started = device->started(aguado.machine, exact);
  EXPECT_TRUE(started.warnings.empty());
  const std::vector<InstrumentPlace> places = started.instrument->places();
  ASSERT_EQ(places.size(), 1U);  // the other station is not estimated
  EXPECT_EQ(places[0].name, "tracker2");
  const RigidTransform expected = truth->setup().stations[1].body_from_tracker;
  EXPECT_LT((places[0].position - expected.translation).norm(), 1e-9);
  EXPECT_LT((*places[0].rotation - expected.rotation).norm(), 1e-12);
}

TEST(LaserTracker, SaysWhatAPlanLacks) {
  TrackerSetup setup = test::aguado_case().setup;
  const auto lacks = [&] {
    return LaserTracker("tracker", setup, TrackerMeasure::cartesian)
        .missing_for_plan()
        .value_or(MissingNumber{})
        .problem;
  };
  EXPECT_EQ(lacks(), "");
  setup.reflectors[1].offset_from_data = true;
  EXPECT_EQ(lacks(), "a plan has no data for the offset of reflector2");
  setup.stations[0].pose_is_known = false;
  EXPECT_EQ(lacks(), "it is not said where tracker1 will stand");
  setup.stations[0].true_pose = RigidTransform::translate({1, 2, 3});
  EXPECT_EQ(lacks(), "a plan has no data for the offset of reflector2");
}

TEST(LaserTracker, SlopesOfAPlaceAreThoseOfDifferences) {
  const auto device = two_stations(test::aguado_case(), TrackerMeasure::cartesian);
  const std::vector<std::size_t> quantities = {6, 9, 11};
  const Eigen::MatrixXd own = device->place_slopes(0, quantities);
  EXPECT_LT((own - device->Instrument::place_slopes(0, quantities)).norm(), 1e-6);
}

}  // namespace
}  // namespace abbe
