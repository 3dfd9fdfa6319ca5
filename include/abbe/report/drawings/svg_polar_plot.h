#pragma once

#include <optional>
#include <string>
#include <vector>

#include "abbe/report/drawings/svg_plot.h"

namespace abbe {

/// A value at an angle, in the unit that the plot names.
struct PolarPoint {
  double angle_rad = 0;  ///< from the first axis towards the second: counter-clockwise on paper
  double value = 0;
};

/// A plot of deviations around a circle as SVG text: circular and radial deviation, error motions of a rotary axis.
/// Computes nothing. The value runs outwards, from `inner` at the centre to `outer` at the rim, at circles of round
/// numbers; the circle of the value zero is drawn stronger. Points that are not finite are gaps.
class PolarPlot {
 public:
  /// @param value_label  with its unit: "deviation in um"
  PolarPlot(std::string title, std::string value_label);

  /// Names of the directions at 0 and 90 degrees, "+X" and "+Y"; default: "0°" and "90°" and so on.
  void name_axes(std::string first, std::string second);
  /// Values at the centre and at the rim at most; default: zero is about half way out, and all points are enclosed.
  void range(double inner, double outer);

  /// @param closed  the last point is joined with the first
  /// @param legend  empty: not in the legend
  void line(std::vector<PolarPoint> points, bool closed, PlotStyle style, std::string legend = "");
  void points(std::vector<PolarPoint> points, Marker marker, PlotStyle style, std::string legend = "");
  /// A circle about the centre of the plot at a value, named where it meets the upper left diagonal.
  void circle(double value, std::string label, PlotStyle style);

  /// For a file.
  std::string svg() const;
  /// For a page.
  SvgPicture picture() const;

 private:
  struct Layout;
  struct Series {
    bool is_line = true, closed = false;
    std::vector<PolarPoint> points;
    Marker marker = Marker::circle;
    PlotStyle style;
    std::string legend;
  };
  struct Circle {
    double value = 0;
    std::string label;
    PlotStyle style;
  };
  AxisTicks ticks(std::size_t count) const;
  std::string drawn(const Layout& layout) const;

  std::string title_, value_label_;
  std::string names_[4] = {"0\xC2\xB0", "90\xC2\xB0", "180\xC2\xB0", "270\xC2\xB0"};
  std::optional<std::pair<double, double>> range_;
  std::vector<Series> series_;
  std::vector<Circle> circles_;
};

}  // namespace abbe
