#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "abbe/errors/actual_pose.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"
#include "abbe/identify/identify.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/surface_probe.h"
#include "liu_scanner_for_test.h"

/// The rotary axes of Liu's scanner from a standard cylinder, exact readings computed elsewhere (tests/golden/liu).
namespace abbe {
namespace {

nlohmann::json published() {
  std::ifstream file(std::string(ABBE_SOURCE_DIR "/tests/golden/liu/calibration.json"));
  return nlohmann::json::parse(file);
}

Eigen::Vector3d vector_of(const nlohmann::json& value) {
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

/// Columns theta_deg, x_mm, y_mm, z_mm, h_mm.
InstrumentReadings readings_of(const Machine& machine, const std::string& name, const std::string& stage) {
  std::ifstream file(std::string(ABBE_SOURCE_DIR "/tests/golden/liu/") + name);
  std::string line;
  std::getline(file, line);
  InstrumentReadings readings;
  readings.measured.resize(1);
  while (std::getline(file, line)) {
    std::istringstream row(line);
    double value[5];
    char comma = 0;
    for (double& v : value) row >> v >> comma;
    std::vector<double> positions(machine.axes.size(), 0.0);
    positions[machine.find_axis(stage)] = value[0] * kDegree;
    positions[machine.find_axis("X")] = value[1];
    positions[machine.find_axis("Y")] = value[2];
    positions[machine.find_axis("Z")] = value[3];
    readings.append(positions, 0);
    readings.measured[0].push_back(value[4]);
  }
  return readings;
}

/// A cylinder of 10 mm somewhere along a direction; where exactly is to be found.
std::shared_ptr<const Instrument> probe_on_cylinder(const Eigen::Vector3d& direction) {
  SurfaceProbeSetup setup;
  SurfaceProbeSetup::Clamping clamping;
  clamping.direction = direction;
  clamping.offset = SetupPoint::open({0, 0, 0});
  clamping.tilt_first = SetupNumber::open(0);
  clamping.tilt_second = SetupNumber::open(0);
  setup.clampings = {clamping};
  return std::make_shared<SurfaceProbe>(setup);
}

struct Calibrated {
  Identification identification;
  Eigen::Vector3d direction, point;
};

/// Tilt and shift of one stage's axis average line and the cylinder, from the perfect machine as start.
Calibrated calibrate(const Machine& machine, const std::string& stage, const std::vector<Component>& components,
                     const std::string& file, const Eigen::Vector3d& along, ErrorSet errors = {}) {
  const std::size_t axis = machine.find_axis(stage);
  for (const Component component : components) errors.locations.push_back({axis, component, 0, 0});
  InstrumentObservations observations(machine, errors, probe_on_cylinder(along), readings_of(machine, file, stage));
  Problem problem = estimate_everything(machine, errors, {borrowed(observations)});
  const std::size_t first = errors.parameter_count() - 3 - components.size();  // three of the tool offset are last
  problem.machine_parameters.clear();
  for (std::size_t i = 0; i < components.size(); ++i) problem.machine_parameters.push_back(first + i);
  Calibrated result{identify(problem), {}, {}};
  const RigidTransform turned = actual_motion(machine, result.identification.errors, axis, 0.5 * std::numbers::pi);
  result.direction = rotation_vector(turned.rotation).normalized();
  const Eigen::Matrix3d normal =
      (Eigen::Matrix3d::Identity() - turned.rotation).transpose() * (Eigen::Matrix3d::Identity() - turned.rotation) +
      result.direction * result.direction.transpose();
  result.point = Ldlt<>(normal).solve((Eigen::Matrix3d::Identity() - turned.rotation).transpose() * turned.translation);
  return result;
}

/// Distance of a point from the line through `on` along `direction`.
double distance_from_line(const Eigen::Vector3d& point, const Eigen::Vector3d& on, const Eigen::Vector3d& direction) {
  return (point - on).cross(direction.normalized()).norm();
}

TEST(StageCalibration, FindsTheAxesOfBothStages) {
  const Machine machine = liu_scanner();
  const nlohmann::json truth = published();
  using enum Component;
  const Calibrated a = calibrate(machine, "A", {Y, Z, B, C}, "calibrate_A_exact.csv", {1, 0, 0});
  ASSERT_EQ(a.identification.status, IdentifyStatus::converged) << a.identification.message;
  EXPECT_LT(distance_from_line(vector_of(truth["A"]["true_point"]), a.point, a.direction), 1e-9);
  EXPECT_LT((a.direction - vector_of(truth["A"]["true_dir"]).normalized()).norm(), 1e-11);
  const Calibrated c = calibrate(machine, "C", {X, Z, A, C}, "calibrate_C_exact.csv", {0, 1, 0});
  ASSERT_EQ(c.identification.status, IdentifyStatus::converged) << c.identification.message;
  EXPECT_LT(distance_from_line(vector_of(truth["C"]["true_point"]), c.point, c.direction), 1e-9);
  EXPECT_LT((c.direction - vector_of(truth["C"]["true_dir"]).normalized()).norm(), 1e-11);
}

}  // namespace
}  // namespace abbe
