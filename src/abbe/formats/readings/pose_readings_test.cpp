// Readings of position and orientation, and covariances in files of any instrument.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <string>

#include "abbe/formats/readings/instrument_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/instruments/trackers/pose_tracker.h"
#include "abbe/machine/chain.h"

namespace abbe {
namespace {

using testing::HasSubstr;

Machine carriage() { return parse_chain("w C' X' b Z t").machine; }

PoseTracker pose_tracker(std::size_t targets = 1) {
  PoseTrackerSetup setup;
  setup.name = "cameras";
  for (std::size_t i = 0; i < targets; ++i) {
    setup.targets.emplace_back().name = "T" + std::to_string(i + 1);
  }
  return PoseTracker(setup);
}

InstrumentReadings parsed_poses(const std::string& text) {
  return parse_instrument_readings(text, "r.csv", carriage(), pose_tracker());
}

std::string message_of_poses(const std::string& text) {
  return message_of([&] { parsed_poses(text); });
}

TEST(PoseReadings, TheSameOrientationInThreeForms) {
  const std::string axes = "C_deg,X_mm,Z_mm,x_mm,y_mm,z_m,", row = "0,1,2,3,4,0.005,";
  const Eigen::Vector3d angles(0.3, -0.2, 2.5);
  const Eigen::Matrix3d rotation = rotation_from_error_angles(angles);
  const Eigen::Quaterniond q(rotation);
  const Eigen::Vector3d v = rotation_vector(rotation);
  const auto numbers = [](std::initializer_list<double> all) {
    std::string text;
    for (const double number : all) text += (text.empty() ? "" : ",") + fmt::format("{:.17g}", number);
    return text + "\n";
  };
  const std::string texts[] = {axes + "a_rad,b_rad,c_rad\n" + row + numbers({angles[0], angles[1], angles[2]}),
                               axes + "rx_rad,ry_rad,rz_rad\n" + row + numbers({v[0], v[1], v[2]}),
                               axes + "qw,qx,qy,qz\n" + row + numbers({-q.w(), -q.x(), -q.y(), -q.z()})};
  for (const std::string& text : texts) {
    const InstrumentReadings read = parsed_poses(text);
    EXPECT_EQ(read.measured, (std::vector<std::vector<double>>{{3}, {4}, {5}, {0}, {0}, {0}}));
    const Eigen::Quaterniond found(read.inputs[0][0], read.inputs[1][0], read.inputs[2][0], read.inputs[3][0]);
    EXPECT_LT((found.toRotationMatrix() - rotation).norm(), 1e-14) << text;
  }
}

TEST(PoseReadings, WhatIsMissingOrTooMuchIsSaid) {
  const std::string axes = "C_deg,X_mm,Z_mm,x_mm,y_mm,z_mm", row = "0,1,2,3,4,5";
  EXPECT_THAT(message_of_poses(axes + "\n" + row + "\n"), HasSubstr("r.csv: qw: the orientation is missing"));
  EXPECT_THAT(message_of_poses(axes + ",a_deg,b_deg\n" + row + ",1,2\n"), HasSubstr("c: missing column"));
  EXPECT_THAT(message_of_poses(axes + ",a_deg,b_deg,c_deg,rx_deg,ry_deg,rz_deg\n" + row + ",1,2,3,1,2,3\n"),
              HasSubstr("the orientation is given twice"));
  EXPECT_THAT(message_of_poses(axes + ",qw,qx,qy,qz\n" + row + ",1,0.5,0,0\n"),
              HasSubstr("r.csv:2: qw: the quaternion has the length 1.11803; expected a length of 1"));
  EXPECT_THAT(message_of_poses(axes + ",qw,qx,qy,qz\n" + row + ",0,0,0,0\n"), HasSubstr("the length 0"));
  EXPECT_THAT(message_of_poses(axes + ",a_deg,b_deg,c_deg,turn_x_deg\n" + row + ",1,2,3,0\n"), HasSubstr("turn_x_deg"));
  EXPECT_THAT(message_of_poses(axes + ",a_deg,b_deg,c_deg\n"), HasSubstr("there are no rows below the header"));
}

TEST(PoseReadings, SimulatedOnesComeBackWithTheirCovariances) {
  const Machine machine = carriage();
  const auto device = std::make_shared<const PoseTracker>(pose_tracker(2));
  InstrumentReadings plan;
  plan.append({0.5, 100, -20}, 1, {0, 0, 0, 0});
  plan.append({-2.5, 30, -90}, 0, {0, 0, 0, 0});
  InstrumentReadings readings = device->simulate(machine, {}, plan, {}).readings;
  readings.uncertainty.clear();
  readings.covariance.assign(21, std::vector<double>(2, 0.0));
  for (std::size_t i = 0; i < 6; ++i) readings.covariance[i] = {1e-4 / (i < 3 ? 1 : 1e4), 2e-4};
  readings.covariance[6] = {0.5e-4, -1e-4};
  const std::string text = instrument_readings_text(machine, *device, readings);
  EXPECT_THAT(text, testing::StartsWith("C_deg,X_mm,Z_mm,item,qw,qx,qy,qz,x_mm,y_mm,z_mm,cov_x_x_um2,cov_y_y_um2,"
                                        "cov_z_z_um2,cov_turn_x_turn_x_arcsec2,"));
  const InstrumentReadings back = parse_instrument_readings(text, "r.csv", machine, *device);
  EXPECT_EQ(back.item, readings.item);
  EXPECT_EQ(back.inputs, readings.inputs);
  EXPECT_EQ(back.measured, readings.measured);
  ASSERT_EQ(back.covariance.size(), 21U);
  for (std::size_t e = 0; e < 21; ++e) {
    for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(back.covariance[e][k], readings.covariance[e][k], 1e-18) << e;
  }
}

TEST(PoseReadings, CovariancesThatCannotBeAreRefusedWithTheirLine) {
  std::string header = "C_deg,X_mm,Z_mm,x_mm,y_mm,z_mm,qw,qx,qy,qz", row = "0,1,2,3,4,5,1,0,0,0";
  const char* const names[] = {"x", "y", "z", "turn_x", "turn_y", "turn_z"};
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      header += std::string(",cov_") + names[i] + "_" + names[j] + (j < 3 ? "_um2" : i < 3 ? "_um_arcsec" : "_arcsec2");
      row += i == j ? ",4" : i == 0 && j == 1 ? ",5" : ",0";
    }
  }
  EXPECT_THAT(message_of_poses(header + "\n" + row + "\n"),
              HasSubstr("r.csv:2: cov_x_x_um2: the covariance of this reading is not positive definite"));
  EXPECT_THAT(message_of_poses(header.substr(0, header.rfind(',')) + "\n" + row.substr(0, row.rfind(',')) + "\n"),
              HasSubstr("cov_turn_z_turn_z: missing column"));
}

TEST(PoseReadings, GivenReadingsNeedAnOrientationOfLengthOne) {
  const auto device = std::make_shared<const PoseTracker>(pose_tracker());
  InstrumentReadings readings;
  readings.inputs.resize(4);
  for (int k = 0; k < 3; ++k) readings.append({0, 1, 2}, 0, {1, 0, 0, 0});
  readings.measured.assign(6, {0, 0, 0});
  const auto message = [&] {
    return message_of([&] { static_cast<void>(given_readings(readings, carriage(), device, "cameras", false)); });
  };
  EXPECT_NO_THROW(static_cast<void>(given_readings(readings, carriage(), device, "cameras", false)));
  EXPECT_FALSE(first_bad_orientation(*device, readings));
  readings.inputs[0][1] = 0;  // of a plan
  EXPECT_THAT(message(),
              HasSubstr("cameras: inputs: reading 1: the quaternion has the length 0; expected a length of 1"));
  EXPECT_EQ(first_bad_orientation(*device, readings)->reading, 1U);
  readings.inputs[0][1] = 1.0011;
  EXPECT_THAT(message(), HasSubstr("reading 1: the quaternion has the length 1.0011"));
  readings.inputs[0][1] = -1.0009;
  EXPECT_FALSE(first_bad_orientation(*device, readings));
}

}  // namespace
}  // namespace abbe
