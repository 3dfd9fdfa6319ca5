#include "abbe/instruments/trackers/pose_tracker.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <numbers>

#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/reading_covariance.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// A tracker before the mill, with a target on the tool; angles far from zero.
PoseTrackerSetup a_pose_tracker() {
  PoseTrackerSetup setup;
  setup.name = "cameras";
  setup.body_from_station = {rotation_from_error_angles({0.4, -0.3, 2.6}), {900, -1500, 400}};
  PoseTrackerSetup::Target target;
  target.name = "frame";
  target.offset = SetupPoint::open({35, -20, 60});
  target.rotation = rotation_from_error_angles({-2.1, 0.5, 1.0});
  setup.targets = {target};
  return setup;
}

InstrumentReadings simulated(const Machine& machine, const ErrorSet& errors, const PoseTrackerSetup& setup,
                             double noise_factor, std::size_t count = 60) {
  InstrumentSimulationOptions options;
  options.noise_factor = noise_factor;
  const auto device = std::make_shared<const PoseTracker>(setup);
  InstrumentReadings plan = test::anywhere(machine, count);
  plan.inputs.assign(4, std::vector<double>(plan.count(), 0.0));
  return device->simulate(machine, errors, plan, options).readings;
}

Quaterniond stated_orientation(const InstrumentReadings& readings, std::size_t k) {
  return {readings.inputs[0][k], readings.inputs[1][k], readings.inputs[2][k], readings.inputs[3][k]};
}

TEST(PoseTracker, ReadsThePoseOfItsTarget) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  const PoseTrackerSetup setup = a_pose_tracker();
  const InstrumentReadings read = simulated(machine, errors, setup, 0);
  for (std::size_t k = 0; k < read.count(); ++k) {
    const std::vector<double> pose = read.poses.pose(k);
    const RigidTransform tool = actual_bed_from_workpiece(machine, errors, pose).inverse() *
                                actual_bed_from_tool(machine, errors, pose) *
                                RigidTransform::translate(-machine.tool_offset - errors.tool_offset_error);
    const Vector3d offset = setup.targets[0].offset.value() + errors.tool_offset_error;
    const RigidTransform expected =
        setup.body_from_station.inverse() * tool * RigidTransform{setup.targets[0].rotation, offset};
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(read.measured[c][k], expected.translation[static_cast<Eigen::Index>(c)], 1e-9);
      EXPECT_EQ(read.measured[3 + c][k], 0);
    }
    EXPECT_LT((stated_orientation(read, k).toRotationMatrix() - expected.rotation).norm(), 1e-12);
    EXPECT_NEAR(stated_orientation(read, k).norm(), 1, 1e-14);
  }
}

TEST(PoseTracker, DerivativesEqualFiniteDifferences) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  PoseTrackerSetup setup = a_pose_tracker();
  const auto device = std::make_shared<const PoseTracker>(setup);
  // At the orientations that were read, and in a plan, where none was.
  InstrumentReadings plan = simulated(machine, errors, setup, 0, 40);
  test::expect_jacobian_equals_differences(machine, errors, device, plan, 1e-6);
}

TEST(PoseTracker, APlanHasTheDerivativesOfTheReadingsItBecomes) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  const PoseTrackerSetup setup = a_pose_tracker();
  const auto device = std::make_shared<const PoseTracker>(setup);
  const InstrumentReadings read = simulated(machine, errors, setup, 0, 30);
  InstrumentReadings plan = read;
  plan.inputs.assign(4, std::vector<double>(plan.count(), 0.0));
  const auto jacobian = [&](const InstrumentReadings& readings) {
    const auto observations = device->observations(machine, errors, readings);
    std::vector<std::size_t> parameters(errors.parameter_count()), unknowns(observations->unknowns().size());
    std::iota(parameters.begin(), parameters.end(), std::size_t{0});
    std::iota(unknowns.begin(), unknowns.end(), std::size_t{0});
    const std::size_t stride = 6 * readings.count();
    std::vector<double> residuals(stride), result(stride * (parameters.size() + unknowns.size()));
    observations->evaluate(0, readings.count(), parameters, unknowns, residuals.data(), result.data(), stride);
    return result;
  };
  const std::vector<double> of_plan = jacobian(plan), of_readings = jacobian(read);
  ASSERT_EQ(of_plan.size(), of_readings.size());
  for (std::size_t i = 0; i < of_plan.size(); ++i) {
    EXPECT_NEAR(of_plan[i], of_readings[i], 1e-8 * std::max(1.0, std::abs(of_readings[i])));
  }
}

TEST(PoseTracker, TurnsAreTangentsOfHalfTheAngleWithoutAJumpBelowHalfATurn) {
  const Machine machine = test::trunnion_mill();
  const PoseTrackerSetup setup = a_pose_tracker();
  const auto device = std::make_shared<const PoseTracker>(setup);
  InstrumentReadings read = simulated(machine, {}, setup, 0, 1);
  const Quaterniond exact = stated_orientation(read, 0);
  for (const double angle : {1e-9, 1e-3, 1.0, 3.0, 3.1}) {
    const Vector3d axis = Vector3d(1, -2, 0.5).normalized();
    const Quaterniond stated = exact * Quaterniond(Eigen::AngleAxisd(-angle, axis));
    for (const double sign : {1.0, -1.0}) {  // both quaternions of an orientation
      read.inputs = {{sign * stated.w()}, {sign * stated.x()}, {sign * stated.y()}, {sign * stated.z()}};
      const std::vector<double> deviation = device->observations(machine, ErrorSet{}, read)->deviation(0);
      for (std::size_t c = 0; c < 3; ++c) {
        const double expected = -2 * std::tan(angle / 2) * axis[static_cast<Eigen::Index>(c)];
        EXPECT_NEAR(deviation[3 + c], expected, 1e-9 * std::max(1e-6, std::abs(expected))) << angle;
      }
    }
  }
}

TEST(PoseTracker, StartIsFoundWithNothingKnown) {
  const Machine machine = test::trunnion_mill();
  const PoseTrackerSetup truth = a_pose_tracker();
  InstrumentReadings read = simulated(machine, {}, truth, 1);
  for (const std::size_t k : {3U, 17U, 40U}) read.measured[1][k] += 80;  // wrong readings
  PoseTrackerSetup setup = truth;
  setup.body_from_station = {};
  setup.pose_is_known = false;
  setup.targets[0].rotation = Matrix3d::Identity();
  setup.targets[0].offset = SetupPoint::open({0, 0, 0});
  const StartedInstrument started = std::make_shared<const PoseTracker>(setup)->started(machine, read);
  ASSERT_EQ(started.fits.size(), 1U);
  EXPECT_TRUE(started.fits[0].found);
  EXPECT_FALSE(started.fits[0].rough);
  EXPECT_TRUE(started.warnings.empty());
  const PoseTrackerSetup found = static_cast<const PoseTracker&>(*started.instrument).setup();
  EXPECT_LT((found.body_from_station.translation - truth.body_from_station.translation).norm(), 0.1);
  EXPECT_LT(rotation_vector(found.body_from_station.rotation * truth.body_from_station.rotation.transpose()).norm(),
            1e-4);
  EXPECT_LT((found.targets[0].offset.value() - truth.targets[0].offset.value()).norm(), 0.1);
  EXPECT_LT(rotation_vector(found.targets[0].rotation * truth.targets[0].rotation.transpose()).norm(), 1e-4);
}

TEST(PoseTracker, OnAMachineThatDoesNotTurnPositionsFindTheStationAndOrientationsTheTarget) {
  const Machine machine = test::three_axis_mill();
  PoseTrackerSetup truth = a_pose_tracker();
  truth.targets[0].offset = SetupPoint::exact({35, -20, 60});
  const InstrumentReadings read = simulated(machine, {}, truth, 0);
  PoseTrackerSetup setup = truth;
  setup.body_from_station = {};
  setup.targets[0].rotation = Matrix3d::Identity();
  const StartedInstrument started = std::make_shared<const PoseTracker>(setup)->started(machine, read);
  ASSERT_TRUE(started.fits[0].found);
  const PoseTrackerSetup found = static_cast<const PoseTracker&>(*started.instrument).setup();
  EXPECT_LT((found.body_from_station.translation - truth.body_from_station.translation).norm(), 1e-6);
  EXPECT_LT((found.targets[0].rotation - truth.targets[0].rotation).norm(), 1e-9);
}

TEST(PoseTracker, TooFewReadingsAndReadingsAtOnePlaceAreSaid) {
  const Machine machine = test::three_axis_mill();
  PoseTrackerSetup setup = a_pose_tracker();
  setup.targets[0].offset = SetupPoint::exact({35, -20, 60});
  const auto device = std::make_shared<const PoseTracker>(setup);
  InstrumentReadings read = simulated(machine, {}, setup, 0, 2);
  StartedInstrument started = device->started(machine, read);
  EXPECT_FALSE(started.fits[0].found);
  EXPECT_THAT(started.warnings, testing::ElementsAre(testing::HasSubstr("fewer than three")));
  read = read.subset({0, 0, 0, 0});
  started = device->started(machine, read);
  EXPECT_FALSE(started.fits[0].found);
  EXPECT_FALSE(started.warnings.empty());
  EXPECT_FALSE(device->started(machine, read.subset({})).fits[0].found);
}

TEST(PoseTracker, CovariancesWeightReadingsAsTheInverseDoes) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  const PoseTrackerSetup setup = a_pose_tracker();
  const auto device = std::make_shared<const PoseTracker>(setup);
  InstrumentReadings read = simulated(machine, errors, setup, 3, 20);
  Eigen::MatrixXd mixed = Eigen::MatrixXd::Random(6, 6);
  mixed.topRows<3>() *= 0.02;
  mixed.bottomRows<3>() *= 1e-4;
  const Eigen::MatrixXd covariance = mixed * mixed.transpose();
  read.covariance.assign(21, {});
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = i; j < 6; ++j) {
      read.covariance[covariance_place(6, i, j)].assign(
          read.count(), covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    }
  }
  const auto with = device->observations(machine, {}, read);
  InstrumentReadings plain = read;
  plain.covariance.clear();
  const auto without = device->observations(machine, {}, plain);
  std::vector<double> residuals(6 * read.count());
  with->evaluate(0, read.count(), {}, {}, residuals.data(), nullptr, 0);
  for (std::size_t k = 0; k < read.count(); ++k) {
    const std::vector<double> deviation = with->deviation(k), expected = without->deviation(k);
    double square = 0;
    for (std::size_t row = 0; row < 6; ++row) {
      EXPECT_NEAR(deviation[row], expected[row], 1e-9 * (1 + std::abs(expected[row])));
      square += residuals[row * read.count() + k] * residuals[row * read.count() + k];
    }
    const Eigen::VectorXd d = Eigen::Map<const Eigen::VectorXd>(expected.data(), 6);
    EXPECT_NEAR(square, d.dot(covariance.ldlt().solve(d)), 1e-6 * square);
  }
  read.covariance[covariance_place(6, 0, 1)][4] = 1;  // a correlation above one
  EXPECT_THROW(device->observations(machine, {}, read), std::invalid_argument);
}

TEST(PoseTracker, RefusesWhatCannotBe) {
  PoseTrackerSetup setup = a_pose_tracker();
  setup.targets.clear();
  EXPECT_THROW(PoseTracker{setup}, std::invalid_argument);
  setup = a_pose_tracker();
  setup.targets[0].body = Body::workpiece;
  EXPECT_THROW(PoseTracker{setup}, std::invalid_argument);
  setup = a_pose_tracker();
  setup.turn_noise = 0;
  EXPECT_THROW(PoseTracker{setup}, std::invalid_argument);
}

}  // namespace
}  // namespace abbe
