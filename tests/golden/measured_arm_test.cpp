// An ABB IRB 120 with three reflectors and a laser tracker, 1000 configurations, measured by others
// (github.com/icelinker/Robot-Calibration-LaserTracker, commit 188abd2). The readings have no licence and are not here:
// the environment variable ABBE_MEASURED_ARM names a folder with generated_joints.txt and measured_SMR_1.txt to
// measured_SMR_3.txt; without it the tests are skipped. docs/real-data.md has the figures.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "abbe/formats/files/empty_folder_for_test.h"
#include "abbe/study/report/unseen.h"
#include "abbe/study/run_study.h"

namespace abbe {
namespace {

const std::filesystem::path kStudies = std::filesystem::path(ABBE_SOURCE_DIR) / "tests/golden/measured_arm";

std::vector<std::vector<double>> rows_of(const std::filesystem::path& file, std::size_t columns) {
  std::ifstream in(file);
  std::vector<std::vector<double>> rows;
  std::vector<double> row(columns);
  while (true) {
    for (double& value : row) in >> value;
    if (!in) return rows;
    rows.push_back(row);
  }
}

/// The readings as Abbe takes them, every fifth configuration apart. @returns configurations
std::size_t write_readings(const std::filesystem::path& from, const std::filesystem::path& to) {
  const auto joints = rows_of(from / "generated_joints.txt", 6);
  std::array<std::vector<std::vector<double>>, 3> points;
  for (std::size_t r = 0; r < 3; ++r) points[r] = rows_of(from / fmt::format("measured_SMR_{}.txt", r + 1), 3);
  std::ofstream train(to / "train.csv"), test(to / "test.csv");
  for (std::ofstream* file : {&train, &test})
    *file << "C1_deg,B1_deg,B2_deg,A1_deg,B3_deg,A2_deg,reflector,measured_x_mm,measured_y_mm,measured_z_mm\n";
  for (std::size_t k = 0; k < joints.size(); ++k) {
    std::ofstream& file = k % 5 == 4 ? test : train;
    for (std::size_t r = 0; r < 3; ++r) {
      for (const double angle : joints[k]) file << fmt::format("{:.9f},", angle);
      const std::vector<double>& p = points[r].at(k);
      file << fmt::format("T{},{:.6f},{:.6f},{:.6f}\n", r + 1, p[0], p[1], p[2]);
    }
  }
  return joints.size();
}

UnseenPoses held_out(const std::filesystem::path& study_file) {
  const Study study = read_study(study_file);
  RunOptions options;
  options.map = false;
  const StudyResult result = run_study(study, options);
  return evaluate_unseen(study, result);
}

/// Root mean square distance of held-out readings from the identified arm, mm.
double rms_of(const UnseenPoses& unseen) {
  double square = 0;
  for (const double distance : unseen.after) square += distance * distance;
  return std::sqrt(square / static_cast<double>(unseen.after.size()));
}

TEST(MeasuredArm, ComplianceUnderGravityLeavesLessThanHalfOfWhatGeometryLeaves) {
  const char* const data = std::getenv("ABBE_MEASURED_ARM");
  if (data == nullptr || *data == '\0') GTEST_SKIP() << "ABBE_MEASURED_ARM names no folder";
  const std::filesystem::path folder = test::empty_folder("measured_arm");
  std::filesystem::copy(kStudies, folder, std::filesystem::copy_options::recursive);
  ASSERT_EQ(write_readings(data, folder), 1000U);
  const double geometry = rms_of(held_out(folder / "geometry.study.toml"));
  const double compliance = rms_of(held_out(folder / "compliance.study.toml"));
  RecordProperty("geometry_um", std::to_string(1e3 * geometry));
  RecordProperty("compliance_um", std::to_string(1e3 * compliance));
  EXPECT_NEAR(geometry, 0.2675, 0.01);
  EXPECT_LE(compliance, 0.1);
  const UnseenPoses noise = held_out(folder / "pose_noise.study.toml");
  EXPECT_LE(rms_of(noise), 0.14);
  ASSERT_TRUE(noise.readings);
  const double within =
      static_cast<double>(noise.readings->components_within) / static_cast<double>(noise.readings->components);
  EXPECT_NEAR(within, 0.95, 0.03);
}

}  // namespace
}  // namespace abbe
