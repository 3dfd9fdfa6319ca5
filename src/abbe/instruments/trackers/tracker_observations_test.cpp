#include "abbe/instruments/trackers/tracker_observations.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <stdexcept>

#include "abbe/errors/actual_pose.h"
#include "abbe/errors/random_stream.h"
#include "abbe/instruments/aguado_for_test.h"
#include "abbe/instruments/trackers/tracker_whitening.h"

namespace abbe {
namespace {

using test::AguadoCase;

Eigen::Vector3d random_vector(RandomStream& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

/// Readings near what a mixed campaign sees: three stations on three bodies, five reflectors on three bodies, in any
/// order.
struct Mixed {
  AguadoCase base = test::aguado_case();
  TrackerReadings readings;
};

Mixed mixed_case(TrackerMeasure measure, StatedUncertainty stated) {
  Mixed mixed;
  RandomStream random(5);
  LocationError location{.axis = 0, .component = Component::A, .value = 1e-4};
  mixed.base.truth.locations.push_back(location);
  mixed.base.truth.tool_offset_error = {0.01, -0.02, 0.03};
  mixed.base.truth.reversals = {{2, -0.012, 0}, {0, 3e-5, 0}};
  TrackerSetup& setup = mixed.base.setup;
  setup.stations.resize(3, setup.stations[0]);
  const Body bodies[] = {Body::workpiece, Body::bed, Body::tool};
  for (std::size_t s = 0; s < 3; ++s) {
    setup.stations[s].name = "tracker" + std::to_string(s + 1);
    setup.stations[s].body = bodies[s];
    setup.stations[s].body_from_tracker = {rotation_from_vector(random_vector(random, 2)), random_vector(random, 400)};
  }
  setup.reflectors.resize(5);
  for (std::size_t r = 3; r < 5; ++r) {
    setup.reflectors[r].name = "reflector" + std::to_string(r + 1);
    setup.reflectors[r].body = r == 3 ? Body::workpiece : Body::bed;
    setup.reflectors[r].offset = random_vector(random, 300);
  }
  for (Reflector& reflector : setup.reflectors) reflector.estimate_offset = true;

  TrackerReadings& readings = mixed.readings;
  readings.measure = measure;
  readings.stated = stated;
  readings.reserve(3, 200);
  while (readings.count() < 200) {
    const std::size_t s = random.bits() % 3, r = random.bits() % 5;
    if (setup.stations[s].body == setup.reflectors[r].body) continue;
    const std::vector<double> positions{random.uniform(0, 6), random.uniform(0, 1400), random.uniform(0, 600)};
    readings.poses.append(positions);
    // An axis stands where half of its reversal value has left it.
    std::vector<double> standing = positions;
    readings.poses.approach.resize(3);
    for (std::size_t i = 0; i < 3; ++i) {
      readings.poses.approach[i].push_back(static_cast<std::int8_t>(static_cast<int>(random.bits() % 3) - 1));
      for (const Reversal& reversal : mixed.base.truth.reversals) {
        if (reversal.axis == i) standing[i] += readings.poses.approach[i].back() * reversal.value / 2;
      }
    }
    readings.station.push_back(static_cast<std::uint16_t>(s));
    readings.reflector.push_back(static_cast<std::uint16_t>(r));
    // An independent route to the reading: the pose of both bodies, one at a time.
    const auto bed_from = [&](Body body) {
      if (body == Body::bed) return RigidTransform();
      if (body == Body::workpiece) return actual_bed_from_workpiece(mixed.base.machine, mixed.base.truth, standing);
      const Eigen::Vector3d tip = mixed.base.machine.tool_offset + mixed.base.truth.tool_offset_error;
      return actual_bed_from_tool(mixed.base.machine, mixed.base.truth, standing) * RigidTransform::translate(-tip);
    };
    const Eigen::Vector3d seen =
        bed_from(setup.stations[s].body).inverse() *
        (bed_from(setup.reflectors[r].body) * reflector_start(setup.reflectors[r], mixed.base.truth));
    const Eigen::Vector3d x = setup.stations[s].body_from_tracker.inverse() * seen;
    const Eigen::Vector3d m = measure == TrackerMeasure::cartesian ? x : range_and_angles_from_point(x);
    for (std::size_t k = 0; k < 3; ++k) readings.measured[k].push_back(m[static_cast<int>(k)]);
    Eigen::Matrix3d root = Eigen::Matrix3d::Identity() * 0.01;
    for (int i = 0; i < 9; ++i) root(i / 3, i % 3) += random.uniform(-0.003, 0.003);
    if (measure == TrackerMeasure::range_and_angles) root.bottomRows(2) *= 1e-3;
    const Eigen::Matrix3d c = root * root.transpose();
    const double full[6] = {c(0, 0), c(1, 1), c(2, 2), c(0, 1), c(0, 2), c(1, 2)};
    for (std::size_t k = 0; k < 6; ++k)
      readings.uncertainty[k].push_back(k < 3 && stated == StatedUncertainty::standard ? std::sqrt(full[k]) : full[k]);
  }
  return mixed;
}

TEST(TrackerObservations, ReproducesTheNoiseFreeReadingsOfAnIndependentModel) {
  const AguadoCase aguado = test::aguado_case();
  const TrackerReadings readings = test::aguado_readings(aguado, "aguado_5000_noise0.csv");
  ASSERT_EQ(readings.count(), 5000u);
  const TrackerObservations observations(aguado.machine, aguado.truth, aguado.setup, readings);
  double largest = 0;
  for (std::size_t k = 0; k < 5000; ++k) largest = std::max(largest, observations.distance(k).norm());
  EXPECT_LT(largest, 1e-8);
}

TEST(TrackerObservations, ErrorOfTheNominalMachineIsThatOfTheIndependentModel) {
  AguadoCase aguado = test::aguado_case();
  // Nominal axis point, not the true one.
  aguado.machine.axes[0].point = {700, 0, -100};
  aguado.machine.bed_from_workpiece.translation = {700, 0, -100};
  const TrackerObservations observations(aguado.machine, ErrorSet(), aguado.setup,
                                         test::aguado_readings(aguado, "aguado_500_noise0.csv"));
  double sum = 0, largest = 0;
  for (std::size_t k = 0; k < 500; ++k) {
    sum += observations.distance(k).norm();
    largest = std::max(largest, observations.distance(k).norm());
  }
  EXPECT_NEAR(1e3 * sum / 500, aguado.json["expected_n500_noise0"]["initial_mean_um"].get<double>(), 1e-3);
  EXPECT_NEAR(1e3 * largest, aguado.json["expected_n500_noise0"]["initial_max_um"].get<double>(), 1e-3);
}

TEST(TrackerObservations, ResidualsOfNoisyReadingsHaveUnitVariance) {
  const AguadoCase aguado = test::aguado_case();
  TrackerObservations observations(aguado.machine, aguado.truth, aguado.setup,
                                   test::aguado_readings(aguado, "aguado_5000_noiseLT.csv"));
  double squares = 0;
  std::vector<double> residuals(3 * Observations::kBlockSize);
  for (std::size_t first = 0; first < 5000; first += Observations::kBlockSize) {
    const std::size_t count = std::min(Observations::kBlockSize, 5000 - first);
    observations.evaluate(first, count, {}, {}, residuals.data(), nullptr, 0);
    for (std::size_t i = 0; i < 3 * count; ++i) squares += residuals[i] * residuals[i];
  }
  // 15,000 squares: standard deviation of their mean 0.0115.
  EXPECT_NEAR(squares / 15000, 1, 0.04);
}

class MixedTracker : public testing::TestWithParam<std::tuple<TrackerMeasure, StatedUncertainty>> {};

TEST_P(MixedTracker, ReadingsOfEveryPairOfBodiesAreReproduced) {
  const Mixed mixed = mixed_case(std::get<0>(GetParam()), std::get<1>(GetParam()));
  const TrackerObservations observations(mixed.base.machine, mixed.base.truth, mixed.base.setup, mixed.readings);
  std::vector<double> residuals(3 * 128);
  for (const std::size_t first : {std::size_t{0}, std::size_t{72}}) {
    observations.evaluate(first, 128, {}, {}, residuals.data(), nullptr, 0);
    for (std::size_t i = 0; i < residuals.size(); ++i) EXPECT_NEAR(residuals[i], 0, 1e-7);
  }
}

TEST_P(MixedTracker, JacobianMatchesCentralDifferences) {
  const Mixed mixed = mixed_case(std::get<0>(GetParam()), std::get<1>(GetParam()));
  TrackerObservations observations(mixed.base.machine, mixed.base.truth, mixed.base.setup, mixed.readings);
  std::vector<double> machine = mixed.base.truth.parameters();
  std::vector<double> setup = observations.unknown_values();
  RandomStream random(8);
  // Away from the given rotation and from zero residual, where second-order slips would hide.
  for (std::size_t i = 0; i < setup.size(); ++i)
    setup[i] += observations.unknowns()[i].is_angle ? random.uniform(-0.4, 0.4) : random.uniform(-5, 5);
  std::vector<std::size_t> machine_parameters, setup_parameters;
  for (std::size_t i = machine.size(); i-- > 0;) machine_parameters.push_back(i);
  for (std::size_t i = 0; i < setup.size(); i += 1 + i % 2) setup_parameters.push_back(i);
  const std::size_t count = 100, first = 30, rows = 3 * count, stride = rows + 5;
  const std::size_t columns = machine_parameters.size() + setup_parameters.size();
  std::vector<double> residuals(rows), more(rows), less(rows), jacobian(columns * stride, -7.0);
  observations.set_parameters(machine, setup);
  observations.evaluate(first, count, machine_parameters, setup_parameters, residuals.data(), jacobian.data(), stride);
  const std::vector<bool> angles = parameters_are_angles(mixed.base.machine, mixed.base.truth);
  for (std::size_t column = 0; column < columns; ++column) {
    const bool is_machine = column < machine_parameters.size();
    const std::size_t index =
        is_machine ? machine_parameters[column] : setup_parameters[column - machine_parameters.size()];
    const bool angle = is_machine ? angles[index] : observations.unknowns()[index].is_angle;
    double& value = is_machine ? machine[index] : setup[index];
    const double kept = value, step = angle ? 1e-6 : 1e-3;
    value = kept + step;
    observations.set_parameters(machine, setup);
    observations.evaluate(first, count, {}, {}, more.data(), nullptr, 0);
    value = kept - step;
    observations.set_parameters(machine, setup);
    observations.evaluate(first, count, {}, {}, less.data(), nullptr, 0);
    value = kept;
    double scale = 0, worst = 0;
    for (std::size_t i = 0; i < rows; ++i) {
      const double expected = -(more[i] - less[i]) / (2 * step);
      scale = std::max(scale, std::abs(expected));
      worst = std::max(worst, std::abs(expected - jacobian[column * stride + i]));
    }
    EXPECT_LE(worst, 2e-6 * scale + 1e-6) << "column " << column << (is_machine ? " machine " : " set-up ") << index;
    if (!is_machine) {
      EXPECT_GT(scale, 0);
    }
  }
  EXPECT_EQ(jacobian[rows], -7.0) << "wrote beyond the rows";
}

INSTANTIATE_TEST_SUITE_P(AllKinds, MixedTracker,
                         testing::Combine(testing::Values(TrackerMeasure::cartesian, TrackerMeasure::range_and_angles),
                                          testing::Values(StatedUncertainty::none, StatedUncertainty::standard,
                                                          StatedUncertainty::covariance)));

TEST(TrackerObservations, WhiteningTurnsTheCovarianceIntoTheIdentity) {
  RandomStream random(3);
  for (int i = 0; i < 50; ++i) {
    Eigen::Matrix3d root;
    for (int k = 0; k < 9; ++k) root(k / 3, k % 3) = random.normal();
    const Eigen::Matrix3d covariance = root * root.transpose() + 0.01 * Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d w = whitening_matrix(covariance);
    EXPECT_LT((w * covariance * w.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
    EXPECT_EQ(w(1, 0), 0);
  }
  Eigen::Matrix3d indefinite = Eigen::Matrix3d::Identity();
  indefinite(0, 1) = indefinite(1, 0) = 1.1;
  EXPECT_THROW(whitening_matrix(indefinite), std::invalid_argument);
}

TEST(TrackerObservations, MovingTheBedFrameMovesNothing) {
  const AguadoCase aguado = test::aguado_case();
  const TrackerReadings readings = test::aguado_readings(aguado, "aguado_500_noise0.csv");
  AguadoCase moved = aguado;
  const Eigen::Vector3d shift(1000, -2000, 500);
  for (Axis& axis : moved.machine.axes) axis.point += shift;
  moved.machine.tool_reference += shift;
  moved.machine.bed_from_workpiece.translation += shift;
  const TrackerObservations observations(moved.machine, moved.truth, moved.setup, readings);
  for (std::size_t k = 0; k < 500; ++k) EXPECT_LT(observations.distance(k).norm(), 1e-8);
}

TEST(TrackerObservations, AnglesMayWrapAndPassThePole) {
  AguadoCase aguado = test::aguado_case();
  aguado.setup.reflectors.resize(1);
  aguado.setup.stations[0].noise = TrackerNoise::range_and_angles(1, 0, 1);
  const std::vector<double> positions{0, 700, 300};
  const TrackerObservations seen_by(aguado.machine, ErrorSet(), aguado.setup, [&] {
    TrackerReadings one;
    one.reserve(3, 1);
    one.poses.append(positions);
    one.station = {0};
    one.reflector = {0};
    for (std::vector<double>& m : one.measured) m = {1};
    return one;
  }());
  // Where the reflector is, seen from the table.
  const Eigen::Vector3d target =
      aguado.setup.stations[0].body_from_tracker * Eigen::Vector3d(Eigen::Vector3d(1, 1, 1) - seen_by.distance(0));
  for (const Eigen::Vector3d& beam :
       {Eigen::Vector3d(-1000, 1e-3, 0), Eigen::Vector3d(1e-4, -2e-4, 900), Eigen::Vector3d(0, 0, -700)}) {
    aguado.setup.stations[0].body_from_tracker.translation =
        target - aguado.setup.stations[0].body_from_tracker.rotation * beam;
    TrackerReadings readings;
    readings.measure = TrackerMeasure::range_and_angles;
    readings.reserve(3, 1);
    readings.poses.append(positions);
    readings.station = {0};
    readings.reflector = {0};
    // The reading is 5 um off across the beam, beyond the wrap or on the other side of the pole.
    const Eigen::Vector3d off = beam + Eigen::Vector3d(0, -5e-3, 0);
    const Eigen::Vector3d m = range_and_angles_from_point(off);
    for (std::size_t k = 0; k < 3; ++k) readings.measured[k] = {m[static_cast<int>(k)]};
    const TrackerObservations observations(aguado.machine, ErrorSet(), aguado.setup, readings);
    double r[3];
    observations.evaluate(0, 1, {}, {}, r, nullptr, 0);
    const double arcsec = std::numbers::pi / 648000;
    EXPECT_NEAR(std::hypot(r[1], r[2]), 5e-3 / beam.norm() / arcsec, 1e-3) << beam.transpose();
    EXPECT_NEAR(r[0], 0, 2e-3);
  }
}

TEST(TrackerObservations, RefusesWhatCannotBeMeasured) {
  const AguadoCase aguado = test::aguado_case();
  const TrackerReadings good = test::aguado_readings(aguado, "aguado_500_noise0.csv");
  const auto refuses = [&](const TrackerSetup& setup, const TrackerReadings& readings, const std::string& words) {
    try {
      const TrackerObservations observations(aguado.machine, aguado.truth, setup, readings);
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
      return;
    }
    ADD_FAILURE() << "accepted: " << words;
  };
  TrackerReadings bad = good;
  bad.measured[1][17] = std::nan("");
  refuses(aguado.setup, bad, "reading 17: measured value");
  bad = good;
  bad.reflector[3] = 9;
  refuses(aguado.setup, bad, "reading 3: no such reflector");
  bad = good;
  bad.poses.axis.pop_back();
  refuses(aguado.setup, bad, "axis columns");
  TrackerSetup setup = aguado.setup;
  setup.stations[0].body = Body::tool;
  refuses(setup, good, "same body");
  setup = aguado.setup;
  setup.stations[0].noise = TrackerNoise();
  refuses(setup, good, "no standard uncertainty");
}

}  // namespace
}  // namespace abbe
