#include "abbe/formats/machine/linkage_file.h"

#include <gtest/gtest.h>

#include <string>

#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

const std::string kLinkageHeader = "mark,X_mm,Y_mm,Z_mm,turn_deg,mark_x_mm,mark_y_mm,height_mm,width_um\n";
// Lines 2 to 9.
const std::string kFirstSteps =
    "exit,,,-409,,,,,\nwidth,,,-285,,,,,60\nl1,,,,,,,239.7,\nl2,,,,,,,240.2,\nl3,0,,,,12.2,,,\nl4,,,,,,24.9,,\n"
    "l5,-418,,,,11.3,,,\nl6,,,,,,25.7,,\n";

LinkageReadings parsed_linkage(const std::string& rows) { return parse_linkage(kLinkageHeader + rows, "x.csv"); }
std::string message_of_linkage(const std::string& rows) {
  return message_of([&] { parsed_linkage(rows); });
}

TEST(LinkageFile, IsReadBackBitByBit) {
  const SwingHeadLinkage truth{240.745, 209.476, -0.265, -0.145, {-197.236, 25.306, -528.996}};
  const LinkageReadings commands = linkage_commands(truth, LinkageConvention::table_moves, 120, 4);
  const LinkageReadings readings = simulate_linkage(truth, commands, 0.03, 0.05);
  const LinkageReadings back = parse_linkage(linkage_text(readings), "x.csv");
  EXPECT_EQ(back.exit_z, readings.exit_z);
  EXPECT_EQ(back.focus_z, readings.focus_z);
  EXPECT_EQ(back.focus_width, readings.focus_width);
  EXPECT_EQ(back.height_first, readings.height_first);
  EXPECT_EQ(back.height_second, readings.height_second);
  EXPECT_EQ(back.x_first, readings.x_first);
  EXPECT_EQ(back.x_second, readings.x_second);
  EXPECT_EQ(back.line3_x, readings.line3_x);
  EXPECT_EQ(back.line4_y, readings.line4_y);
  EXPECT_EQ(back.line5_x, readings.line5_x);
  EXPECT_EQ(back.line6_y, readings.line6_y);
  EXPECT_EQ(back.circle_x, readings.circle_x);
  EXPECT_EQ(back.circle_z, readings.circle_z);
  ASSERT_EQ(back.circle_marks.size(), readings.circle_marks.size());
  EXPECT_EQ(back.circle_marks.back(), readings.circle_marks.back());
  EXPECT_NEAR(back.table_angle.back(), readings.table_angle.back(), 1e-15);
}

TEST(LinkageFile, OtherUnitsAndAPointInsteadOfACircle) {
  const LinkageReadings r = parse_linkage(
      "width_mm,mark,Z_um,height_um,X_mm,mark_x_mm,mark_y_mm,Y_mm\n"
      ",exit,-409000,,,,,\n0.06,width,-285000,,,,,\n,l1,,239700,,,,\n,l2,,240200,,,,\n,l3,,,0,12.2,,\n,l4,,,,,24.9,\n"
      ",l5,,,-418,11.3,,\n,l6,,,,,25.7,\n,point,-284200,,-196.8,,,234.8\n",
      "x.csv");
  EXPECT_EQ(r.exit_z, -409);
  EXPECT_EQ(r.focus_width, std::vector<double>{0.06});
  EXPECT_EQ(r.height_second, 240.2);
  EXPECT_EQ(r.circle_y, 234.8);
  EXPECT_TRUE(r.circle_marks.empty());
}

TEST(LinkageFile, WhatIsWrongIsNamedWithItsLineAndColumn) {
  EXPECT_EQ(
      message_of_linkage(kFirstSteps),
      "x.csv: mark: there is no row 'circle' or 'point'; expected step 5: marks of a circle while the table turns, "
      "or the commands that make it a point");
  EXPECT_EQ(message_of_linkage("exit,,,-409,,,,,\n"),
            "x.csv: mark: there is no row 'width'; expected step 2: a line while Z goes through the focus");
  EXPECT_EQ(
      message_of_linkage("line7,,,-409,,,,,\n"),
      "x.csv:2: mark: 'line7' is not a mark of the five steps; expected one of exit, width, l1, l2, l3, l4, l5, l6, "
      "circle, point");
  EXPECT_EQ(message_of_linkage(kFirstSteps + "l6,,,,,,25.7,,\n"),
            "x.csv:10: mark: 'l6' is already in line 9; expected one such row");
  EXPECT_EQ(message_of_linkage("exit,,,,,,,,\n"),
            "x.csv:2: Z_mm: is empty; expected a number in the row 'exit' (step 2: the exit of the beam level with the "
            "table)");
  EXPECT_EQ(message_of_linkage("exit,,,-409,,,,,60\n"),
            "x.csv:2: width_um: a number that the row 'exit' has no use for; expected an empty field (step 2: the exit "
            "of the beam level with the table)");
  EXPECT_EQ(message_of_linkage("width,,,-285,,,,,wide\n"),
            "x.csv:2:18: width_um: 'wide' is not a number; expected a length in um above zero");
  EXPECT_EQ(message_of_linkage(kFirstSteps + "circle,1,2,3,0,0,1,,\ncircle,1,2,4,30,0,1,,\n"),
            "x.csv:11: Z_mm: differs from the first row 'circle'; expected one position of X, Y and Z for the whole "
            "circle: only the table turns");
  EXPECT_EQ(message_of_linkage(kFirstSteps + "circle,1,2,3,0,0,1,,\npoint,1,2,4,,,,,\n"),
            "x.csv:11: mark: is given together with 'circle'; expected either marks of a circle or the commands that "
            "make it a "
            "point");
  EXPECT_EQ(
      message_of([] { parse_linkage("mark,X_mm\nexit,\n", "x.csv"); }),
      "x.csv:2: Z_mm, Z_um or Z_m: there is no such column; expected a number in the row 'exit' (step 2: the exit "
      "of the beam level with the table)");
}

}  // namespace
}  // namespace abbe
