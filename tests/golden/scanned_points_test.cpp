#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "abbe/errors/actual_pose.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/readings/scan_file.h"
#include "abbe/geometry/angle_units.h"
#include "liu_scanner_for_test.h"

/// Points of Liu's scanner from axis positions and indications, computed elsewhere (tests/golden/liu/points.csv).
namespace abbe {
namespace {

std::string readings() { return read_text_file(std::string(ABBE_SOURCE_DIR "/tests/golden/liu/points.csv")); }

/// Axis average lines of Table 3: A through (dx, dy, dz) along (1, tan d1, tan d2), C along (tan d1, 1, tan d2).
ErrorSet table_3(const Machine& machine, double shift_unit) {
  const std::size_t a = machine.find_axis("A"), c = machine.find_axis("C");
  const double a1 = 0.0741 * kDegree, a2 = 0.3413 * kDegree, c1 = 0.5035 * kDegree, c2 = -0.8466 * kDegree;
  using enum Component;
  ErrorSet errors;
  errors.locations = {{a, C, a1, 0},
                      {a, B, -std::atan(std::tan(a2) * std::cos(a1)), 0},
                      {a, Y, (-0.0012 - 0.8424 * std::tan(a1)) * shift_unit, 0},
                      {a, Z, (0.0177 - 0.8424 * std::tan(a2)) * shift_unit, 0},
                      {c, C, -c1, 0},
                      {c, A, std::atan(std::tan(c2) * std::cos(c1)), 0},
                      {c, X, (0.2906 - 0.5074 * std::tan(c1)) * shift_unit, 0},
                      {c, Z, (0.6875 - 0.5074 * std::tan(c2)) * shift_unit, 0}};
  return errors;
}

/// Coordinates of all rows by the streaming route.
CsvTable scanned(const Machine& machine, const ErrorSet& errors) {
  ScanOptions options;
  options.mapping.columns = {{"X_mm", "x_mm"}, {"Y_mm", "y_mm"}, {"Z_mm", "z_mm"}, {"indication_mm", "h_mm"}};
  for (const char* set : {"nominal_", "t3mm_", "t3um_"}) {
    for (const char* coordinate : {"x", "y", "z"}) {
      options.mapping.ignore.push_back(std::string(set) + coordinate);
    }
  }
  options.decimals = 12;
  std::string text;
  scan_points(readings(), "points.csv", machine, PointScan(machine, errors, {}), ScanFormat::csv, options,
              [&](std::string_view piece) { text += piece; });
  return read_csv(text, "points", {{"x", Quantity::length}, {"y", Quantity::length}, {"z", Quantity::length}});
}

CsvTable published(const std::string& set) {
  ColumnMapping mapping;
  std::vector<CsvColumn> wanted;
  for (const char* coordinate : {"x", "y", "z"}) wanted.push_back({set + coordinate, Quantity::dimensionless});
  for (const char* other : {"x_mm", "y_mm", "z_mm", "A_deg", "C_deg", "h_mm"}) mapping.ignore.push_back(other);
  for (const char* other : {"nominal_", "t3mm_", "t3um_"}) {
    for (const char* coordinate : {"x", "y", "z"}) {
      if (set != other) mapping.ignore.push_back(std::string(other) + coordinate);
    }
  }
  return read_csv(readings(), "points.csv", wanted, mapping);
}

void expect_equal(const CsvTable& found, const CsvTable& expected) {
  ASSERT_EQ(found.rows, expected.rows);
  ASSERT_GE(found.rows, 30U);
  for (std::size_t k = 0; k < found.rows; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_NEAR(found.columns[i].numbers[k], expected.columns[i].numbers[k], 1e-9) << k << " " << i;
    }
  }
}

TEST(ScannedPoints, AreThePublishedOnesOfThePerfectMachine) {
  expect_equal(scanned(liu_scanner(), {}), published("nominal_"));
}

TEST(ScannedPoints, AreThePublishedOnesWithTheShiftsOfTable3InMillimetresAndInMicrometres) {
  const Machine machine = liu_scanner();
  expect_equal(scanned(machine, table_3(machine, 1)), published("t3mm_"));
  expect_equal(scanned(machine, table_3(machine, 1e-3)), published("t3um_"));
}

}  // namespace
}  // namespace abbe
