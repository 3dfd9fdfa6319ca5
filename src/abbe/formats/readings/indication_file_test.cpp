#include "abbe/formats/readings/indication_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "abbe/formats/controls/turntable_machine_for_test.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const std::string kHeader = "X_mm,direction,place_x_mm,place_y_mm,place_z_mm,indication_um,u_um\n";

IndicationTable parsed_indications(const std::string& text, const IndicationOptions& options = {}) {
  return parse_indications(text, "x.csv", test::one_turn_turntable(), options);
}
std::string message_of_indications(const std::string& text) {
  return message_of([&] { parsed_indications(text); });
}

TEST(IndicationFile, ReadsRowsInAnyOrder) {
  const IndicationTable table =
      parsed_indications(kHeader +
                         "# a grid of two places and a laser\n"
                         "40,Z,0,0,0,1.5,0.6\n0,Z,0,0,0,-2.5,0.6\n0,-Y,0,30,0,3,0.6\n40,-Y,0,30,0,4,0.6\n"
                         "40,+X,0,0,80,7,0.011\n0,X,0,0,80,6,0.011\n");
  EXPECT_EQ(table.axis, 1U);
  const AxisIndications& readings = table.readings;
  EXPECT_EQ(readings.direction, 0U);
  EXPECT_EQ(readings.sense, -1);
  EXPECT_EQ(readings.positions, (std::vector<double>{0, 40}));
  ASSERT_EQ(readings.probes.size(), 3U);
  EXPECT_EQ(readings.probes[1].direction, Eigen::Vector3d(0, -1, 0));
  EXPECT_EQ(readings.probes[1].place, Eigen::Vector3d(0, 30, 0));
  EXPECT_EQ(readings.probes[2].standard_uncertainty, 11e-6);
  Eigen::MatrixXd expected(2, 3);
  expected << -0.0025, 0.003, 0.006, 0.0015, 0.004, 0.007;
  EXPECT_EQ(readings.indications, expected);
}

TEST(IndicationFile, RotaryAxisAndStatedUncertainties) {
  const std::string text =
      "C_deg,direction,place_x_mm,place_y_mm,place_z_mm,indication_mm\n0,X,0,0,20,0\n90,X,0,0,20,1\n"
      "0,Z,0,0,9,0\n90,Z,0,0,9,0\n";
  const IndicationTable table = parsed_indications(text, {.along_axis = 1e-5, .across_axis = 6e-4});
  EXPECT_EQ(table.readings.kind, AxisKind::rotary);
  EXPECT_DOUBLE_EQ(table.readings.positions[1], std::acos(0.0));
  EXPECT_EQ(table.readings.probes[0].standard_uncertainty, 6e-4);
  EXPECT_EQ(table.readings.probes[1].standard_uncertainty, 1e-5);
  EXPECT_EQ(message_of_indications(text), "x.csv: u_um: missing column; expected the standard uncertainty, u_um");
}

TEST(IndicationFile, WhatIsWrittenReadsBackToTheSameBits) {
  const IndicationTable table =
      parsed_indications(kHeader + "0,Z,0.1,0,0,1.7,0.6\n1e-3,Z,0.1,0,0,-1e-7,0.6\n1400,Z,0.1,0,0,3,0.6\n");
  const std::string text = indications_text(test::one_turn_turntable(), table);
  const IndicationTable back = parsed_indications(text);
  EXPECT_EQ(back.readings.positions, table.readings.positions);
  EXPECT_EQ(back.readings.indications, table.readings.indications);
  EXPECT_EQ(back.readings.probes[0].place, table.readings.probes[0].place);
  EXPECT_EQ(indications_text(test::one_turn_turntable(), back), text);
}

TEST(IndicationFile, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(message_of_indications("X,direction,place_x_mm,place_y_mm,place_z_mm,indication_um\n0,Z,0,0,0,1\n"),
            "x.csv:1:1: X: the unit is missing from the name of this column; expected X_mm, X_um or X_m");
  EXPECT_EQ(message_of_indications("direction,place_x_mm,place_y_mm,place_z_mm,indication_um\nZ,0,0,0,1\n"),
            "x.csv: no column with the commands of an axis; expected one of C_deg, X_mm, Z_mm");
  EXPECT_EQ(
      message_of_indications("X_mm,Z_mm,direction,place_x_mm,place_y_mm,place_z_mm,indication_um\n0,0,Z,0,0,0,1\n"),
      "x.csv: Z_mm: is given together with X_mm; expected readings of one axis a file");
  EXPECT_EQ(message_of_indications(kHeader + "0,Z,0,0,0,1,0.6\n40,up,0,0,0,1,0.6\n"),
            "x.csv:3: direction: 'up' is not a direction; expected X, Y, Z, -X, -Y or -Z");
  EXPECT_EQ(
      message_of_indications(kHeader + "0,Z,0,0,0,1,0.6\n40,Z,0,0,0,1,0.6\n0,Z,0,5,0,2,0.6\n"),
      "x.csv: indication_um: no reading in direction Z at (0, 5, 0) mm at X = 40 mm; expected one reading of every "
      "probe at every position");
  EXPECT_EQ(
      message_of_indications(kHeader + "0,Z,0,0,0,1,0.6\n\n0,Z,0,0,0,2,0.6\n"),
      "x.csv:4: indication_um: a second reading in direction Z at (0, 0, 0) mm at X = 0 mm, after line 2; expected "
      "one reading of every probe at every position");
  EXPECT_EQ(message_of_indications(kHeader + "0,Z,0,0,0,1,0.6\n40,Z,0,0,0,1,0.5\n"),
            "x.csv:3: u_um: this probe had another uncertainty in an earlier row; expected 0.6 um");
  EXPECT_THAT(message_of_indications(kHeader + "0,Z,0,0,0,1,-0.6\n"), HasSubstr("x.csv:2:13: u_um: is -0.6"));
  EXPECT_EQ(message_of_indications(kHeader + "0,Z,0,0,0,1,1e-300\n"),
            "x.csv:2: u_um: is 1e-300 um; expected at least 1e-6 um");
  EXPECT_THAT(message_of_indications(kHeader + "0,Z,0,0,0,nan,0.6\n"), HasSubstr("x.csv:2:11: indication_um: "));
}

TEST(IndicationFile, RefusesMoreThanItCanDecouple) {
  std::string text = kHeader;
  for (int i = 0; i <= 500; ++i) text += std::to_string(i) + ",Z,0,0,0,1,0.6\n";
  EXPECT_EQ(message_of_indications(text), "x.csv: X_mm: 501 different positions; expected at most 500");
}

TEST(IndicationFile, TheDocumentedExampleIsAccepted) {
  const std::string text = read_text_file(std::filesystem::path(ABBE_DOCS) / "dial-grids.md");
  const std::string begin = "```csv\n";
  const std::size_t at = text.find(begin);
  ASSERT_NE(at, std::string::npos);
  const std::size_t from = at + begin.size();
  const IndicationTable table = parsed_indications(text.substr(from, text.find("```", from) - from));
  EXPECT_EQ(table.readings.probes.size(), 3U);
  EXPECT_EQ(table.readings.positions.size(), 2U);
}

TEST(IndicationFile, RefusesAnInclinedAxis) {
  Machine inclined = test::one_turn_turntable();
  inclined.axes[1].direction = Eigen::Vector3d(0.6, 0.8, 0);
  EXPECT_EQ(message_of([&] { parse_indications(kHeader + "0,Z,0,0,0,1,0.6\n", "x.csv", inclined); }),
            "x.csv: X_mm: axis X is inclined in this machine; expected an axis along X, Y or Z");
}

}  // namespace
}  // namespace abbe
