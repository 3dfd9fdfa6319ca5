#include "abbe/report/drawings/svg_plot.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace abbe {
namespace {

constexpr double kWidth = 860, kLeft = 74, kRight = 24, kBottom = 58, kPlotHeight = 380;
constexpr double kTitleHeight = 36, kRowHeight = 20, kColumnWidth = 40, kNarrowColumnWidth = 26;
constexpr double kNarrowPlotHeight = 240, kLineHeight = 16, kNarrowTitle = 14;
const PlotStyle kGrid{PlotColour::soft, 1, false, 0.22};
const PlotStyle kAxis{PlotColour::soft, 1.2};

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

/// Of a dimension beside the plot, with its name in bold letters.
double column_width(const std::string& label, double least) {
  return std::max(least, 16 + 1.15 * text_width(label, 13));
}

double lines_of(const std::string& name) { return static_cast<double>(text_lines(name, kNarrowWidth, 12).size()); }

/// Room for the numbers of the second axis.
double narrow_left(const AxisTicks& ticks) {
  double left = 0;
  for (const std::string& label : ticks.labels) left = std::max(left, 10 + 1.15 * text_width(label, 12));
  return left;
}

void draw_key(SvgDrawing& drawing, DrawingPoint at, const LegendEntry& entry) {
  if (entry.is_area) {
    const DrawingPoint corners[] = {{at.x, at.y - 5}, {at.x + 22, at.y - 5}, {at.x + 22, at.y + 5}, {at.x, at.y + 5}};
    drawing.area(corners, entry.style);
  } else if (entry.is_line) {
    drawing.line(at, {at.x + 22, at.y}, entry.style);
  } else {
    drawing.marker({at.x + 11, at.y}, entry.marker, entry.style);
  }
}

}  // namespace

struct XyPlot::Layout {
  bool is_narrow = false;
  double width = kWidth, column = kColumnWidth;
};

double draw_legend(SvgDrawing* drawing, DrawingPoint at, double width, std::span<const LegendEntry> entries) {
  double x = at.x, y = at.y;
  for (const LegendEntry& entry : entries) {
    const double needed = 30 + text_width(entry.text, 12) + 18;
    if (x > at.x && x + needed > at.x + width) {
      x = at.x;
      y += kRowHeight;
    }
    if (drawing != nullptr) {
      draw_key(*drawing, {x, y}, entry);
      drawing->text({x + 29, y + 4}, entry.text);
    }
    x += needed;
  }
  return entries.empty() ? 0 : y - at.y + kRowHeight;
}

double draw_narrow_legend(SvgDrawing* drawing, DrawingPoint at, double width, std::span<const LegendEntry> entries) {
  double x = at.x, y = at.y, row = kLineHeight;
  for (const LegendEntry& entry : entries) {
    const std::vector<std::string> lines = text_lines(entry.text, width - 29, 12);
    const double needed = 29 + text_width(lines.size() == 1 ? lines.front() : entry.text, 12) + 12;
    if (x > at.x && x + needed > at.x + width) {
      x = at.x;
      y += row;
    }
    if (drawing != nullptr) {
      draw_key(*drawing, {x, y}, entry);
      for (std::size_t i = 0; i < lines.size(); ++i) {
        drawing->text({x + 29, y + 4 + kLineHeight * static_cast<double>(i)}, lines[i]);
      }
    }
    row = kLineHeight * static_cast<double>(std::max<std::size_t>(lines.size(), 1)) + 2;
    x += needed;
  }
  return entries.empty() ? 0 : y - at.y + row;
}

double draw_narrow_title(SvgDrawing* drawing, const std::string& title) {
  double y = 4;
  // Bold letters are wider.
  for (const std::string& line : text_lines(title, kNarrowWidth / 1.08, kNarrowTitle)) {
    y += kNarrowTitle + 4;
    if (drawing != nullptr) drawing->text({0, y - 4}, line, TextAnchor::start, kNarrowTitle, PlotColour::ink, true);
  }
  return y;
}

struct XyPlot::Frame {
  const Layout& layout;
  double left = kLeft, right = 0, top = 0, bottom = 0, height = 0, legend_y = 0, y_name = 0, drawing_height = 0;
  AxisTicks x, y;
  std::vector<LegendEntry> legend;
  DrawingPoint at(PlotPoint p) const { return {x_of(p.x), y_of(p.y)}; }
  double x_of(double value) const { return left + (right - left) * (value - x.from()) / (x.to() - x.from()); }
  double y_of(double value) const { return bottom - (bottom - top) * (value - y.from()) / (y.to() - y.from()); }
};

XyPlot::XyPlot(std::string title, std::string x_label, std::string y_label)
    : title_(std::move(title)), x_label_(std::move(x_label)), y_label_(std::move(y_label)) {}

void XyPlot::line(std::vector<PlotPoint> points, PlotStyle style, std::string legend) {
  series_.push_back({Kind::line, std::move(points), Marker::circle, style, std::move(legend)});
}

void XyPlot::points(std::vector<PlotPoint> points, Marker marker, PlotStyle style, std::string legend) {
  series_.push_back({Kind::points, std::move(points), marker, style, std::move(legend)});
}

void XyPlot::band(std::span<const double> x, std::span<const double> low, std::span<const double> high, PlotStyle style,
                  std::string legend) {
  assert(x.size() == low.size() && x.size() == high.size());
  std::vector<PlotPoint> outline;
  for (std::size_t i = 0; i < x.size(); ++i) outline.push_back({x[i], low[i]});
  for (std::size_t i = x.size(); i-- > 0;) outline.push_back({x[i], high[i]});
  series_.push_back({Kind::band, std::move(outline), Marker::circle, style, std::move(legend)});
}

void XyPlot::level(double y, std::string label, PlotStyle style) { levels_.push_back({y, std::move(label), style}); }

void XyPlot::dimension(double x, double low, double high, std::string label, PlotStyle style, double shift_px) {
  dimensions_.push_back({{x, low}, {x, high}, false, std::move(label), style, shift_px});
}

void XyPlot::outer_dimension(PlotPoint low, PlotPoint high, std::string label, PlotStyle style) {
  dimensions_.push_back({low, high, true, std::move(label), style, 0});
}

XyPlot::Frame XyPlot::frame(const Layout& layout) const {
  Range x, y;
  for (const Series& series : series_) {
    for (const PlotPoint& point : series.points) {
      x.add(point.x);
      y.add(point.y);
    }
  }
  for (const Level& level : levels_) y.add(level.y);
  for (const double value : included_) y.add(value);
  double columns = 0;
  for (const Dimension& dimension : dimensions_) {
    for (const PlotPoint& point : {dimension.low, dimension.high}) {
      x.add(point.x);
      y.add(point.y);
    }
    if (dimension.outer) columns += column_width(dimension.label, layout.column);
  }
  Frame frame{layout, kLeft, 0, 0, 0, 0, 0, 0, 0, {}, {}, {}};
  frame.right = layout.width - kRight - columns;
  frame.height = layout.is_narrow ? kNarrowPlotHeight : kPlotHeight;
  const std::size_t x_count = layout.is_narrow ? 5 : same_scale_ ? 8 : 10, y_count = layout.is_narrow ? 5 : 8;
  frame.y = nice_ticks(y.low, y.high, y_count);
  if (layout.is_narrow) {
    frame.right = layout.width - std::max(12.0, columns);
    frame.left = narrow_left(frame.y);
  }
  if (same_scale_) {
    frame.height = frame.right - frame.left;
    const double reach = std::max(x.high - x.low, y.high - y.low) / 2;
    if (std::isfinite(reach)) {
      const double cx = (x.low + x.high) / 2, cy = (y.low + y.high) / 2;
      x = {cx - reach, cx + reach};
      y = {cy - reach, cy + reach};
    }
  }
  frame.y = nice_ticks(y.low, y.high, y_count);
  if (layout.is_narrow) {
    frame.left = narrow_left(frame.y);
    // Half of the last number of the axis stands to the right of its end.
    frame.x = fitting_ticks(x.low, x.high, x_count, x_degrees_, frame.right - frame.left);
    frame.right = std::min(frame.right, layout.width - 2 - 1.15 * text_width(frame.x.labels.back(), 12) / 2);
  } else {
    frame.x = nice_ticks(x.low, x.high, x_count, x_degrees_);
  }
  // Long numbers keep clear of the name of the axis.
  if (!same_scale_ && !layout.is_narrow) {
    for (const std::string& label : frame.y.labels)
      frame.left = std::max(frame.left, 34 + 1.15 * text_width(label, 12));
  }
  if (same_scale_) {
    // The ticks may have widened one axis more than the other.
    const double wider = std::max(frame.x.to() - frame.x.from(), frame.y.to() - frame.y.from());
    frame.height = (frame.right - frame.left) * (frame.y.to() - frame.y.from()) / wider;
    frame.right = frame.left + (frame.right - frame.left) * (frame.x.to() - frame.x.from()) / wider;
  }
  for (const Series& series : series_) {
    if (series.legend.empty()) continue;
    frame.legend.push_back(
        {series.legend, series.style, series.kind == Kind::line, series.kind == Kind::band, series.marker});
  }
  if (layout.is_narrow) {
    frame.legend_y = draw_narrow_title(nullptr, title_) + 12;
    frame.y_name = frame.legend_y + draw_narrow_legend(nullptr, {0, 0}, layout.width, frame.legend) + 6;
    frame.top = frame.y_name + kLineHeight * lines_of(y_label_) + 2;
    frame.bottom = frame.top + frame.height;
    frame.drawing_height = frame.bottom + 26 + kLineHeight * lines_of(x_label_);
    return frame;
  }
  frame.legend_y = kTitleHeight + 14;
  frame.top = frame.legend_y + draw_legend(nullptr, {kLeft, 0}, kWidth - kLeft - kRight, frame.legend) + 2;
  frame.bottom = frame.top + frame.height;
  frame.drawing_height = frame.bottom + kBottom;
  return frame;
}

/// Title, legend and what the axes show.
void XyPlot::draw_names(SvgDrawing& drawing, const Frame& frame) const {
  const double middle = (frame.left + frame.right) / 2;
  if (!frame.layout.is_narrow) {
    drawing.text({middle, frame.bottom + 42}, x_label_, TextAnchor::middle, 13);
    drawing.text({20, (frame.top + frame.bottom) / 2}, y_label_, TextAnchor::middle, 13, PlotColour::ink, false, -90);
    return;
  }
  // Beside the axis its name would take the room of the plot.
  double y = frame.y_name;
  for (const std::string& line : text_lines(y_label_, kNarrowWidth, 12)) {
    drawing.text({0, y}, line);
    y += kLineHeight;
  }
  y = frame.bottom + 36;
  for (const std::string& line : text_lines(x_label_, kNarrowWidth, 12)) {
    const double half = text_width(line, 12) / 2;
    drawing.text(
        {std::clamp(middle, std::min(half, kNarrowWidth / 2), std::max(kNarrowWidth - half, kNarrowWidth / 2)), y},
        line, TextAnchor::middle);
    y += kLineHeight;
  }
}

void XyPlot::draw_axes(SvgDrawing& drawing, const Frame& frame) const {
  for (std::size_t i = 0; i < frame.x.values.size(); ++i) {
    const double x = frame.x_of(frame.x.values[i]);
    drawing.line({x, frame.top}, {x, frame.bottom}, kGrid);
    drawing.text({x, frame.bottom + 18}, frame.x.labels[i], TextAnchor::middle, 12, PlotColour::soft);
  }
  for (std::size_t i = 0; i < frame.y.values.size(); ++i) {
    const double y = frame.y_of(frame.y.values[i]);
    drawing.line({frame.left, y}, {frame.right, y}, frame.y.values[i] == 0 ? kAxis : kGrid);
    drawing.text({frame.left - 8, y + 4}, frame.y.labels[i], TextAnchor::end, 12, PlotColour::soft);
  }
  drawing.line({frame.left, frame.top}, {frame.left, frame.bottom}, kAxis);
  drawing.line({frame.left, frame.bottom}, {frame.right, frame.bottom}, kAxis);
  draw_names(drawing, frame);
}

void XyPlot::draw_dimensions(SvgDrawing& drawing, const Frame& frame) const {
  double column = frame.right + (frame.layout.is_narrow ? 10 : 20);
  for (const Dimension& dimension : dimensions_) {
    const DrawingPoint low = frame.at(dimension.low), high = frame.at(dimension.high);
    const double middle = (low.y + high.y) / 2 + 4;
    if (!dimension.outer) {
      const double x = low.x + dimension.shift_px;
      drawing.dimension(x, low.y, high.y, dimension.style);
      // Towards the inside of the plot, so that the name is not cut off.
      const bool on_the_left = low.x > (frame.left + frame.right) / 2;
      drawing.text({x + (on_the_left ? -7 : 7), middle}, dimension.label,
                   on_the_left ? TextAnchor::end : TextAnchor::start, 13, dimension.style.colour, true);
      continue;
    }
    const PlotStyle extension{dimension.style.colour, 1, true, 0.7};
    drawing.line(low, {column + 5, low.y}, extension);
    drawing.line(high, {column + 5, high.y}, extension);
    drawing.dimension(column, low.y, high.y, dimension.style);
    drawing.text({column + 5, middle}, dimension.label, TextAnchor::start, 13, dimension.style.colour, true);
    column += column_width(dimension.label, frame.layout.column);
  }
}

std::string XyPlot::svg() const { return drawn({}); }

SvgPicture XyPlot::picture() const { return {svg(), drawn({true, kNarrowWidth, kNarrowColumnWidth})}; }

std::string XyPlot::drawn(const Layout& layout) const {
  const Frame frame = this->frame(layout);
  SvgDrawing drawing(layout.width, frame.drawing_height, title_);
  if (layout.is_narrow) {
    draw_narrow_title(&drawing, title_);
    draw_narrow_legend(&drawing, {0, frame.legend_y}, layout.width, frame.legend);
  } else {
    drawing.text({kLeft, 27}, title_, TextAnchor::start, 16, PlotColour::ink, true);
    draw_legend(&drawing, {kLeft, frame.legend_y}, kWidth - kLeft - kRight, frame.legend);
  }
  draw_axes(drawing, frame);
  for (const Series& series : series_) {
    std::vector<DrawingPoint> points;
    points.reserve(series.points.size());
    for (const PlotPoint& point : series.points) points.push_back(frame.at(point));
    if (series.kind == Kind::line) drawing.polyline(points, series.style);
    if (series.kind == Kind::band) drawing.area(points, series.style);
    if (series.kind != Kind::points) continue;
    for (const DrawingPoint& point : points) drawing.marker(point, series.marker, series.style);
  }
  for (const Level& level : levels_) {
    const double y = frame.y_of(level.y);
    drawing.line({frame.left, y}, {frame.right, y}, level.style);
    // In a narrow drawing a long name has several lines, the last one on the level.
    std::vector<std::string> lines = {level.label};
    if (layout.is_narrow) lines = text_lines(level.label, frame.right - frame.left - 8, 12);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const double up = kLineHeight * static_cast<double>(lines.size() - 1 - i);
      drawing.text({frame.right - 4, y - 5 - up}, lines[i], TextAnchor::end, 12, level.style.colour);
    }
  }
  draw_dimensions(drawing, frame);
  return drawing.svg();
}

}  // namespace abbe
