#pragma once

#include <span>
#include <string>
#include <vector>

#include "abbe/report/drawings/svg_drawing.h"

namespace abbe {

/// A value over another one, in the units that the labels of the axes name.
struct PlotPoint {
  double x = 0, y = 0;
};

/// A plot over two straight axes as SVG text. Computes nothing: it draws what it is given, in the order in which it is
/// given, scales the axes to enclose everything and divides them at round numbers. Points that are not finite are gaps.
class XyPlot {
 public:
  /// @param x_label, y_label  with their units: "position in mm"
  XyPlot(std::string title, std::string x_label, std::string y_label);

  /// The first axis is in degrees: divided at 15, 30, 45, ... degrees.
  void divide_x_in_degrees() { x_degrees_ = true; }
  /// The axes have the same scale and enclose the data in a square.
  void keep_the_same_scale() { same_scale_ = true; }
  /// Makes the second axis enclose this value.
  void include_y(double y) { included_.push_back(y); }

  /// @param legend  empty: not in the legend
  void line(std::vector<PlotPoint> points, PlotStyle style, std::string legend = "");
  void points(std::vector<PlotPoint> points, Marker marker, PlotStyle style, std::string legend = "");
  /// Area between two lines over the same x. All three have the same length.
  void band(std::span<const double> x, std::span<const double> low, std::span<const double> high, PlotStyle style,
            std::string legend = "");
  /// A straight line from edge to edge, named at its right end: a tolerance, a mean.
  void level(double y, std::string label, PlotStyle style);
  /// A dimension arrow at x from low to high, named beside it.
  /// @param shift_px  moves it to the right, so that two at the same x do not cover each other
  void dimension(double x, double low, double high, std::string label, PlotStyle style, double shift_px = 0);
  /// A dimension arrow to the right of the plot, one column each, with extension lines from the points that it spans.
  void outer_dimension(PlotPoint low, PlotPoint high, std::string label, PlotStyle style);

  /// For a file.
  std::string svg() const;
  /// For a page.
  SvgPicture picture() const;

 private:
  struct Layout;
  enum class Kind { line, points, band };
  struct Series {
    Kind kind = Kind::line;
    std::vector<PlotPoint> points;  // of a band: there below, back above
    Marker marker = Marker::circle;
    PlotStyle style;
    std::string legend;
  };
  struct Level {
    double y = 0;
    std::string label;
    PlotStyle style;
  };
  struct Dimension {
    PlotPoint low, high;
    bool outer = false;
    std::string label;
    PlotStyle style;
    double shift_px = 0;
  };
  struct Frame;

  Frame frame(const Layout& layout) const;
  std::string drawn(const Layout& layout) const;
  void draw_names(SvgDrawing& drawing, const Frame& frame) const;
  void draw_axes(SvgDrawing& drawing, const Frame& frame) const;
  void draw_dimensions(SvgDrawing& drawing, const Frame& frame) const;

  std::string title_, x_label_, y_label_;
  bool x_degrees_ = false, same_scale_ = false;
  std::vector<double> included_;
  std::vector<Series> series_;
  std::vector<Level> levels_;
  std::vector<Dimension> dimensions_;
};

/// One entry of a legend.
struct LegendEntry {
  std::string text;
  PlotStyle style;
  bool is_line = true;  ///< else a marker, or an area
  bool is_area = false;
  Marker marker = Marker::circle;
};

/// Draws entries in rows from `at` on within a width. @return height used, px; 0 without entries
double draw_legend(SvgDrawing* drawing, DrawingPoint at, double width, std::span<const LegendEntry> entries);
/// The same with texts in several lines where they are longer than the width.
double draw_narrow_legend(SvgDrawing* drawing, DrawingPoint at, double width, std::span<const LegendEntry> entries);

/// Title of a narrow drawing, in lines. @return y below it, px
double draw_narrow_title(SvgDrawing* drawing, const std::string& title);

}  // namespace abbe
