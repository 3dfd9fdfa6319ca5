#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// Colours of plots by what they are for. What they look like is decided by the style sheet of the drawing, once for
/// light and once for dark paper.
enum class PlotColour { first, second, third, fourth, fifth, sixth, ink, soft, limit };

struct PlotStyle {
  PlotColour colour = PlotColour::first;
  double width = 1.6;  ///< of lines, px
  bool dashed = false;
  double opacity = 1;
};

enum class Marker { circle, up, down, cross };

enum class TextAnchor { start, middle, end };

/// A place on the drawing, px, y downwards.
struct DrawingPoint {
  double x = 0, y = 0;
};

/// Elements of one SVG picture; knows nothing of axes. Numbers are written with two decimals whatever the locale, so
/// the same picture has the same bytes. Points that are not finite end a line and begin a new one behind them.
class SvgDrawing {
 public:
  /// @param title  read by screen readers; any text
  SvgDrawing(double width, double height, std::string_view title);

  void line(DrawingPoint from, DrawingPoint to, const PlotStyle& style);
  void polyline(std::span<const DrawingPoint> points, const PlotStyle& style);
  /// Closed and filled, without an outline.
  void area(std::span<const DrawingPoint> points, const PlotStyle& style);
  /// Centre, radius; an outline.
  void circle(DrawingPoint centre, double radius, const PlotStyle& style);
  void marker(DrawingPoint at, Marker marker, const PlotStyle& style);
  /// Line with arrow heads at both ends, vertical: a dimension.
  void dimension(double x, double y1, double y2, const PlotStyle& style);
  /// @param size   px
  /// @param angle  degrees, clockwise
  void text(DrawingPoint at, std::string_view text, TextAnchor anchor = TextAnchor::start, double size = 12,
            PlotColour colour = PlotColour::ink, bool bold = false, double angle = 0);

  /// The picture: one <svg> element with its own style sheet, which can stand alone or within a page.
  std::string svg() const;

 private:
  double width_, height_;
  std::string title_, elements_;
};

/// A picture of SvgDrawing in the colours of light paper, whatever the screen, and without variables of style sheets,
/// which not every program that prints understands.
std::string svg_for_paper(std::string svg);

/// One drawing in two layouts.
struct SvgPicture {
  std::string wide;    ///< for a file, for paper and for a wide window
  std::string narrow;  ///< the same, kNarrowWidth px wide, for the window of a telephone
};

/// Of the narrow layout, px: what a page leaves of a window of 360 px.
constexpr double kNarrowWidth = 320;

/// Text for XML: the five special characters as entities, control characters dropped, bytes that are no UTF-8 replaced
/// by U+FFFD.
std::string xml_text(std::string_view text);

/// About how wide a text will be, px; the font of the reader is not known.
double text_width(std::string_view text, double size);

/// A text in lines of at most this width, broken at spaces; a longer word has a line of its own.
std::vector<std::string> text_lines(std::string_view text, double width, double size);

/// Round numbers at which an axis is divided.
struct AxisTicks {
  std::vector<double> values;       ///< ascending; the first is not above, the last not below the data
  std::vector<std::string> labels;  ///< same decimals for all; U+2212 for minus
  double from() const { return values.front(); }
  double to() const { return values.back(); }
};

/// Steps of 1, 2 or 5 times a power of ten that enclose [low, high] in about `count` divisions. An empty or single
/// range is widened; a range that is not finite is taken as 0..1.
/// @param degrees  steps of 15, 30, 45, 90, ... as well, where a power of ten would be coarser than 10
AxisTicks nice_ticks(double low, double high, std::size_t count, bool degrees = false);
/// The same with as many divisions, `count` at most, as leave room for the numbers below an axis of this length, px.
AxisTicks fitting_ticks(double low, double high, std::size_t count, bool degrees, double length);

}  // namespace abbe
