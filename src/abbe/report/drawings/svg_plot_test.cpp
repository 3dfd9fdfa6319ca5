#include "abbe/report/drawings/svg_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "abbe/report/drawings/svg_polar_plot.h"
#include "abbe/report/drawings/xml_for_test.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(NiceTicks, EncloseTheDataAtOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_THAT(nice_ticks(0.3, 9.1, 5).values, ElementsAre(0, 2, 4, 6, 8, 10));
  EXPECT_THAT(nice_ticks(-0.011, 0.02, 8).values,
              testing::Pointwise(testing::DoubleNear(1e-15),
                                 std::vector<double>{-0.015, -0.01, -0.005, 0, 0.005, 0.01, 0.015, 0.02}));
  EXPECT_THAT(nice_ticks(-0.011, 0.02, 8).labels[0],
              "\xE2\x88\x92"
              "0.015");
  EXPECT_THAT(nice_ticks(-0.011, 0.02, 8).labels[3], "0.000");
  for (const double scale : {1e-6, 1.0, 37.0, 1e6}) {
    const AxisTicks ticks = nice_ticks(-1.3 * scale, 2.9 * scale, 8);
    EXPECT_LE(ticks.from(), -1.3 * scale);
    EXPECT_GE(ticks.to(), 2.9 * scale);
    EXPECT_LE(ticks.values.size(), 12U);
    EXPECT_GE(ticks.values.size(), 5U);
    EXPECT_EQ(ticks.values.size(), ticks.labels.size());
  }
}

TEST(NiceTicks, OfDegreesAreThePartsOfACircle) {
  EXPECT_THAT(nice_ticks(0, 360, 10, true).values, ElementsAre(0, 45, 90, 135, 180, 225, 270, 315, 360));
  EXPECT_THAT(nice_ticks(-90, 90, 10, true).values, ElementsAre(-90, -60, -30, 0, 30, 60, 90));
  EXPECT_THAT(nice_ticks(0, 1, 5, true).values.size(), 6U);
}

TEST(NiceTicks, HaveAnAnswerForRangesThatAreNone) {
  for (const auto& [low, high] : std::vector<std::pair<double, double>>{{0, 0},
                                                                        {5, 5},
                                                                        {1, -1},
                                                                        {kNan, 1},
                                                                        {-1e300, 1e300},
                                                                        {-1.7e308, 1.7e308},
                                                                        {1e9, 1e9 + 1e-9},
                                                                        {1e-300, 2e-300}}) {
    const AxisTicks ticks = nice_ticks(low, high, 8);
    ASSERT_GE(ticks.values.size(), 2U) << low;
    EXPECT_LE(ticks.values.size(), 30U) << low;
    EXPECT_LT(ticks.from(), ticks.to()) << low;
  }
}

TEST(XmlText, EscapesWhatWouldBeMarkupAndReplacesWhatIsNoText) {
  EXPECT_EQ(xml_text("a<b>&\"c'"), "a&lt;b&gt;&amp;&quot;c&#39;");
  EXPECT_EQ(xml_text("\xC2\xB5m \xE2\x88\x92 \xF0\x9D\x91\xA5"), "\xC2\xB5m \xE2\x88\x92 \xF0\x9D\x91\xA5");
  EXPECT_EQ(xml_text("caf\xE9!"), "caf\xEF\xBF\xBD!");
  EXPECT_EQ(xml_text(std::string("a\0\x01\x7F\nb", 6)), "a b");
  // Overlong, surrogate, beyond U+10FFFF, cut off.
  for (const char* const none : {"\xC0\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xE2\x88"}) {
    EXPECT_THAT(xml_text(none), testing::StartsWith("\xEF\xBF\xBD"));
  }
}

XyPlot every_element() {
  XyPlot plot("</title><script>alert(1)</script> & \"x\"", "position in mm", "deviation in \xC2\xB5m");
  const std::vector<double> x = {0, 100, 200}, low = {-2, -1, 0}, high = {1, 2, 3};
  plot.band(x, low, high, {PlotColour::first, 0, false, 0.2}, "band <");
  plot.line({{0, 1}, {100, 2}, {200, -1}}, {PlotColour::first}, "line &");
  plot.points({{0, 1}, {100, 2}, {200, -1}}, Marker::up, {PlotColour::second}, "points");
  plot.level(4, "limit", {PlotColour::limit, 1, true});
  plot.dimension(100, -1, 2, "R", {PlotColour::ink});
  plot.outer_dimension({0, -2}, {200, 3}, "A", {PlotColour::ink});
  return plot;
}

TEST(XyPlot, IsWellFormedAndTextInItStaysText) {
  const std::string svg = every_element().svg();
  EXPECT_EQ(xml_problem(svg), "");
  EXPECT_THAT(svg, Not(HasSubstr("<script")));
  EXPECT_THAT(svg, HasSubstr("band &lt;"));
  EXPECT_THAT(svg, HasSubstr("line &amp;"));
  EXPECT_THAT(svg, HasSubstr("prefers-color-scheme:dark"));
}

TEST(XyPlot, DrawsAPointWhereItsValueIs) {
  XyPlot plot("t", "x", "y");
  plot.line({{0, 0}, {10, 0}, {10, 10}}, {PlotColour::third});
  // Ticks 0..10 on both axes: the corners of the plot. Left 74, right 860 - 24; height 380.
  EXPECT_THAT(plot.svg(), HasSubstr("M74.00 432.00L836.00 432.00L836.00 52.00\" fill=\"none\" stroke=\"var(--s3)\""));
}

TEST(XyPlot, LongNumbersKeepClearOfTheNameOfTheAxis) {
  const auto left = [](double reach) {
    XyPlot plot("title", "x", "y");
    plot.line({{0, -reach}, {1, reach}}, {PlotColour::first}, "");
    const std::string svg = plot.svg();
    const std::string zero = ">0</text>";  // the first number of the x axis stands at the left end
    const std::size_t end = svg.find(zero), at = svg.rfind("x=\"", end) + 3;
    return std::stod(svg.substr(at, svg.find('"', at) - at));
  };
  EXPECT_EQ(left(10), left(100));
  EXPECT_GT(left(12345678), left(100) + 10);
}

TEST(XyPlot, TheNameOfADimensionBesideThePlotIsNotCutOff) {
  for (const std::string label : {"A", "1.44 um", "12345.67 arcsec"}) {
    XyPlot plot("t", "x", "y");
    plot.line({{0, 0}, {1, 1}}, {PlotColour::first});
    plot.outer_dimension({0, 0}, {1, 1}, label, {PlotColour::ink});
    const std::string svg = plot.svg();
    const auto number_after = [&](const std::string& what, std::size_t from) {
      return std::stod(svg.substr(svg.find(what, from) + what.size()));
    };
    const double width = number_after("viewBox=\"0 0 ", 0);
    const std::size_t at = svg.rfind("<text", svg.find(">" + label + "<"));
    ASSERT_NE(at, std::string::npos) << svg;
    // Bold letters are some 0.6 of their height wide.
    EXPECT_LT(number_after(" x=\"", at) + 0.6 * 13 * static_cast<double>(label.size()), width) << label;
  }
}

TEST(XyPlot, PointsThatAreNotFiniteAreGaps) {
  XyPlot plot("t", "x", "y");
  plot.line({{0, 0}, {5, kNan}, {10, 0}, {10, 10}, {kNan, 3}}, {PlotColour::third});
  plot.points({{kNan, 1}}, Marker::cross, {});
  const std::string svg = plot.svg();
  EXPECT_THAT(svg, HasSubstr("M74.00 432.00M836.00 432.00L836.00 52.00\""));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

TEST(XyPlot, WithoutDataIsAnEmptyFrame) {
  const std::string svg = XyPlot("", "", "").svg();
  EXPECT_EQ(xml_problem(svg), "");
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(XyPlot, WithTheSameScaleDrawsASquareAsASquare) {
  XyPlot plot("t", "x", "y");
  plot.keep_the_same_scale();
  plot.line({{-1, -1}, {1, -1}, {1, 1}}, {PlotColour::third});
  plot.line({{-3, 0}, {4, 0}}, {PlotColour::fourth});
  const std::string svg = plot.svg();
  const std::size_t at = svg.find("stroke=\"var(--s3)\"");
  const std::size_t path = svg.rfind("d=\"M", at);
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0, x2 = 0, y2 = 0;
  ASSERT_EQ(std::sscanf(svg.c_str() + path, "d=\"M%lf %lfL%lf %lfL%lf %lf", &x0, &y0, &x1, &y1, &x2, &y2), 6);
  EXPECT_NEAR(x1 - x0, y1 - y2, 0.02);
  EXPECT_EQ(y0, y1);
  EXPECT_GT(x1 - x0, 50);
}

TEST(PolarPlot, DrawsAnglesCounterClockwiseAndZeroBetweenCentreAndRim) {
  PolarPlot plot("t", "deviation in \xC2\xB5m");
  plot.name_axes("+X", "+Y");
  plot.line({{0, 0}, {std::numbers::pi / 2, 10}, {std::numbers::pi, 0}, {0, kNan}, {3, -10}}, true, {PlotColour::third},
            "forward");
  const std::string svg = plot.svg();
  EXPECT_EQ(xml_problem(svg), "");
  EXPECT_THAT(svg, HasSubstr("\xE2\x88\x92X"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  const std::size_t path = svg.rfind("d=\"M", svg.find("stroke=\"var(--s3)\"", svg.find("forward")));
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0, x2 = 0, y2 = 0;
  ASSERT_EQ(std::sscanf(svg.c_str() + path, "d=\"M%lf %lfL%lf %lfL%lf %lf", &x0, &y0, &x1, &y1, &x2, &y2), 6);
  const double centre_x = (x0 + x2) / 2;
  EXPECT_NEAR(centre_x, x1, 0.02);
  EXPECT_NEAR(y0, y2, 0.02);
  EXPECT_NEAR(y0 - y1, 250, 0.02) << "the largest value is at the rim";
  EXPECT_GT(x0 - x1, 100) << "zero is well outside the centre";
}

TEST(PolarPlot, NumbersOfItsCirclesKeepClearOfEachOther) {
  PolarPlot plot("t", "v");
  plot.line({{0, 0.31}, {1, -0.62}, {2, 0.6}, {3, 0.1}}, true, {});
  const std::string svg = plot.svg();
  std::vector<double> right_to_left;
  std::size_t widest = 0;
  for (std::size_t at = svg.find("<text"); at != std::string::npos; at = svg.find("<text", at + 1)) {
    double x = 0, y = 0, size = 0;
    if (std::sscanf(svg.c_str() + at, "<text x=\"%lf\" y=\"%lf\" font-size=\"%lf\"", &x, &y, &size) != 3) continue;
    if (size != 11) continue;
    right_to_left.push_back(x);
    const std::size_t from = svg.find('>', at) + 1;
    widest = std::max(widest, svg.find('<', from) - from);
  }
  ASSERT_GE(right_to_left.size(), 3U);
  for (std::size_t i = 1; i < right_to_left.size(); ++i) {
    // A minus sign is three bytes and one letter.
    EXPECT_GT(right_to_left[i] - right_to_left[i - 1], text_width(std::string(widest - 2, '0'), 11) + 3)
        << "letters of some fonts are wider";
  }
}

TEST(PolarPlot, WithoutDataOrDeviationHasAFrame) {
  EXPECT_EQ(xml_problem(PolarPlot("", "").svg()), "");
  PolarPlot plot("t", "v");
  plot.points({{0, 0}, {1, 0}}, Marker::circle, {});
  plot.circle(0, "mean", {});
  EXPECT_EQ(xml_problem(plot.svg()), "");
}

/// Sizes of the letters of a drawing, px, with the ends of every text that is not turned.
struct WrittenText {
  double left, right, size;
};

std::vector<WrittenText> texts_of(const std::string& svg) {
  std::vector<WrittenText> texts;
  for (std::size_t at = svg.find("<text"); at != std::string::npos; at = svg.find("<text", at + 1)) {
    double x = 0, y = 0, size = 0;
    if (std::sscanf(svg.c_str() + at, "<text x=\"%lf\" y=\"%lf\" font-size=\"%lf\"", &x, &y, &size) != 3) continue;
    const std::size_t from = svg.find('>', at) + 1;
    const std::string tag = svg.substr(at, from - at), words = svg.substr(from, svg.find('<', from) - from);
    if (tag.find("rotate") != std::string::npos) continue;
    const double width = text_width(words, size);
    const double left = x - (tag.find("\"end\"") != std::string::npos      ? width
                             : tag.find("\"middle\"") != std::string::npos ? width / 2
                                                                           : 0);
    texts.push_back({left, left + width, size});
  }
  return texts;
}

TEST(NarrowPicture, HasLettersOfTwelvePixelsWithinItsWidth) {
  const std::string words = "a long name of many words that does not fit on one line of the narrow drawing, not at all";
  XyPlot plot(words, "first axis: " + words, "second axis: " + words);
  plot.line({{0, -1234.5}, {100000, 2000}, {250000, 3000}}, {PlotColour::first}, "first line: " + words);
  plot.points({{0, 1}, {100000, 2}}, Marker::up, {PlotColour::second}, "points");
  plot.level(4, words, {PlotColour::limit, 1, true});
  plot.outer_dimension({0, -2}, {200, 3}, "A", {PlotColour::ink});
  PolarPlot polar(words, "deviation in \xC2\xB5m");
  polar.line({{0, 0.31}, {1, -0.62}, {2, 0.6}, {3, 0.1}}, true, {}, words);
  polar.circle(0.5, "0.50", {});
  for (const SvgPicture& picture : {plot.picture(), polar.picture()}) {
    EXPECT_EQ(xml_problem(picture.narrow), "");
    EXPECT_THAT(picture.narrow, HasSubstr("viewBox=\"0 0 320.00 "));
    EXPECT_GE(texts_of(picture.narrow).size(), 10U);
    for (const WrittenText& text : texts_of(picture.narrow)) {
      EXPECT_GE(text.size, 12);
      EXPECT_GE(text.left, 0);
      EXPECT_LE(text.right, kNarrowWidth);
    }
  }
  EXPECT_EQ(plot.picture().wide, plot.svg());
  EXPECT_EQ(polar.picture().wide, polar.svg());
}

TEST(NarrowPicture, NumbersBelowTheAxisKeepClearOfEachOther) {
  for (const double reach : {1.0, 1234.5678, 9.9e6}) {
    const AxisTicks ticks = fitting_ticks(0.123 * reach, reach, 5, false, 250);
    double widest = 0;
    for (const std::string& label : ticks.labels) widest = std::max(widest, text_width(label, 12));
    EXPECT_GE(250 / static_cast<double>(ticks.values.size() - 1), widest + 8) << reach;
  }
}

TEST(TextLines, BreakAtSpaces) {
  EXPECT_THAT(text_lines("one two three", 56, 10), ElementsAre("one two", "three"));
  EXPECT_THAT(text_lines("wonderfully long", 10, 10), ElementsAre("wonderfully", "long"));
  EXPECT_THAT(text_lines("", 10, 10), testing::IsEmpty());
}

TEST(SvgDrawing, TheSameElementsGiveTheSameBytes) { EXPECT_EQ(every_element().svg(), every_element().svg()); }

TEST(SvgPlot, ForPaperItHasTheLightColoursAndNoVariables) {
  XyPlot plot("a", "x", "y");
  plot.line({{0, 0}, {1, 1}}, {PlotColour::second});
  const std::string screen = plot.svg(), paper = svg_for_paper(screen);
  EXPECT_NE(screen.find("var(--"), std::string::npos);
  EXPECT_EQ(paper.find("var("), std::string::npos);
  EXPECT_EQ(paper.find("--"), std::string::npos);
  EXPECT_EQ(paper.find("prefers-color-scheme"), std::string::npos);
  EXPECT_NE(paper.find("stroke=\"#b4551d\""), std::string::npos);
  EXPECT_NE(paper.find("<style>.abbe-plot{font-family"), std::string::npos);
}

}  // namespace
}  // namespace abbe
