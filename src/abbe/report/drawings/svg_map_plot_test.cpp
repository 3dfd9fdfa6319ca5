#include "abbe/report/drawings/svg_map_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "abbe/report/drawings/xml_for_test.h"

namespace abbe {
namespace {

std::size_t count_of(const std::string& text, const std::string& words) {
  std::size_t count = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++count;
  return count;
}

TEST(MapPlot, EveryPanelHasItsOwnScaleAndEmptyCellsAreNotDrawn) {
  MapPlot plot("Map", {"X in mm", 0, 1400, 3}, {"Z in mm", 0, 600, 2}, "error in um");
  plot.add({"before", {0, 100, 200, 300, 400, 812}});
  plot.add({"after", {-1, 2, -3, 4, std::numeric_limits<double>::quiet_NaN(), 5.5}});
  const std::string svg = plot.svg();
  EXPECT_EQ(xml_problem(svg), "");
  // 11 cells, two scales of 20 steps, and 8 numbers in the soft colour at each panel.
  EXPECT_EQ(count_of(svg, "fill=\"var(--s"), 67U);
  for (const char* text : {">812<", ">5.5<", ">-5.5<", ">1400<", ">before<", ">after<", ">error in um<"}) {
    EXPECT_THAT(svg, testing::HasSubstr(text));
  }
  EXPECT_THAT(svg, testing::Not(testing::HasSubstr("nan")));
}

TEST(MapPlot, InTheNarrowLayoutLongNamesOfPanelsHaveSeveralLinesAboveTheCells) {
  MapPlot plot("Map", {"X in mm", 0, 1400, 3}, {"Z in mm", 0, 600, 2}, "error in um");
  plot.add({"compensated: order 4, 4 harmonics and a constant for every axis", {0, 1, 2, 3, 4, 5}});
  const SvgPicture picture = plot.picture();
  EXPECT_EQ(picture.wide, plot.svg());
  EXPECT_EQ(xml_problem(picture.narrow), "");
  EXPECT_THAT(picture.narrow, testing::HasSubstr("viewBox=\"0 0 320.00 "));
  EXPECT_THAT(picture.narrow, testing::Not(testing::HasSubstr("harmonics and a constant for every axis<")));
  EXPECT_THAT(picture.narrow, testing::HasSubstr("for every axis<"));
}

TEST(MapPlot, AMapOfZerosIsDrawn) {
  MapPlot plot("Zero", {"x", 0, 1, 2}, {"y", 0, 1, 2}, "um");
  plot.add({"", {0, 0, 0, 0}});
  EXPECT_THAT(plot.svg(), testing::Not(testing::HasSubstr("nan")));
}

}  // namespace
}  // namespace abbe
