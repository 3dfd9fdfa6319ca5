#include "abbe/formats/evaluations/section_file.h"

#include <gtest/gtest.h>

#include <numbers>

#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

TEST(SectionFile, SectionsComeInOrderOfAppearanceWithTheirPointsInOrder) {
  const std::vector<SectionReadings> sections = parse_sections(
      "section,along_mm,across_um,height_um,beam_tilt_deg\n"
      "b,4,10,1,0.5\na,8,20,2,-0.5\nb,4,30,3,0.5\n",
      "x.csv");
  ASSERT_EQ(sections.size(), 2U);
  EXPECT_EQ(sections[0].name, "b");
  ASSERT_EQ(sections[0].points.cols(), 2);
  EXPECT_DOUBLE_EQ(sections[0].points(0, 1), 0.03);
  EXPECT_DOUBLE_EQ(sections[0].points(1, 1), 0.003);
  EXPECT_EQ(sections[0].along, 4.0);
  EXPECT_DOUBLE_EQ(*sections[1].beam_tilt, -0.5 * std::numbers::pi / 180);
  const std::vector<SectionReadings> again = parse_sections(sections_csv(sections), "again.csv");
  ASSERT_EQ(again.size(), 2U);
  EXPECT_LT((again[0].points - sections[0].points).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_NEAR(*again[1].beam_tilt, *sections[1].beam_tilt, 1e-10);
}

TEST(SectionFile, WhatIsOptionalIsWrittenOnItsOwnAndNeverAsZero) {
  std::vector<SectionReadings> sections(2);
  for (SectionReadings& section : sections) {
    section.name = &section == &sections[0] ? "A" : "B";
    section.points = Eigen::Matrix2Xd::Constant(2, 3, 0.5);
    section.beam_tilt = 0.125;
  }
  const std::vector<SectionReadings> tilted = parse_sections(sections_csv(sections), "tilted.csv");
  ASSERT_EQ(tilted.size(), 2U);
  EXPECT_FALSE(tilted[0].along);
  ASSERT_TRUE(tilted[1].beam_tilt);
  EXPECT_NEAR(*tilted[1].beam_tilt, 0.125, 1e-10);
  sections[1].beam_tilt.reset();
  EXPECT_THROW(sections_csv(sections), std::invalid_argument);
  sections[0].beam_tilt.reset();
  sections[1].along = 4;
  EXPECT_THROW(sections_csv(sections), std::invalid_argument);
  sections[1].along.reset();
  EXPECT_EQ(sections_csv(sections).substr(0, 28), "section,across_mm,height_mm\n");
}

TEST(SectionFile, WhatIsWrongIsNamedWithItsLine) {
  EXPECT_EQ(
      message_of([] { parse_sections("section,along_mm,across_mm,height_mm\nA,1,0,0\nA,2,1,0\n", "x.csv"); }),
      "x.csv:3: along_mm: not that of the rows of section 'A' before; expected the same on all rows of a section");
  EXPECT_NE(message_of([] { parse_sections("section,across_mm\nA,1\n", "x.csv"); }).find("height"), std::string::npos);
  EXPECT_NE(message_of([] { parse_sections("section,across_mm,height_mm\n", "x.csv"); }).find("no rows"),
            std::string::npos);
}

}  // namespace
}  // namespace abbe
