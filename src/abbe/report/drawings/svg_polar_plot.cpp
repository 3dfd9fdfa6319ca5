#include "abbe/report/drawings/svg_polar_plot.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace abbe {
namespace {

constexpr double kPolarWidth = 620, kSideMargin = 24, kMargin = 52, kRadius = 250;
constexpr double kNarrowRadius = 115;
const PlotStyle kPolarGrid{PlotColour::soft, 1, false, 0.25};
const PlotStyle kZero{PlotColour::soft, 1.4};

}  // namespace

struct PolarPlot::Layout {
  bool is_narrow = false;
  double width = kPolarWidth, radius = kRadius, scale_size = 11;
  std::size_t divisions = 8;
};

PolarPlot::PolarPlot(std::string title, std::string value_label)
    : title_(std::move(title)), value_label_(std::move(value_label)) {}

void PolarPlot::name_axes(std::string first, std::string second) {
  const auto opposite = [](const std::string& name) {
    if (name.starts_with('+')) return "\xE2\x88\x92" + name.substr(1);
    return "\xE2\x88\x92" + name;
  };
  names_[2] = opposite(first);
  names_[3] = opposite(second);
  names_[0] = std::move(first);
  names_[1] = std::move(second);
}

void PolarPlot::range(double inner, double outer) { range_ = std::pair(inner, outer); }

void PolarPlot::line(std::vector<PolarPoint> points, bool closed, PlotStyle style, std::string legend) {
  series_.push_back({true, closed, std::move(points), Marker::circle, style, std::move(legend)});
}

void PolarPlot::points(std::vector<PolarPoint> points, Marker marker, PlotStyle style, std::string legend) {
  series_.push_back({false, false, std::move(points), marker, style, std::move(legend)});
}

void PolarPlot::circle(double value, std::string label, PlotStyle style) {
  circles_.push_back({value, std::move(label), style});
}

AxisTicks PolarPlot::ticks(std::size_t count) const {
  double low = 0, high = 0;
  const auto add = [&](double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  };
  for (const Series& series : series_) {
    for (const PolarPoint& point : series.points) add(point.value);
  }
  for (const Circle& circle : circles_) add(circle.value);
  if (range_) {
    // Never so narrow that a point would lie on the wrong side of the centre or outside the rim.
    add(range_->first);
    add(range_->second);
    return nice_ticks(low, high, count);
  }
  const double reach = std::max(-low, high);
  if (reach == 0) return nice_ticks(-1, 1, 4);
  // Room at the centre, where lines would crowd.
  return nice_ticks(std::min(-reach, 1.5 * low), reach, count);
}

std::string PolarPlot::svg() const { return drawn({}); }

SvgPicture PolarPlot::picture() const { return {svg(), drawn({true, kNarrowWidth, kNarrowRadius, 12, 5})}; }

std::string PolarPlot::drawn(const Layout& layout) const {
  std::vector<LegendEntry> legend;
  for (const Series& series : series_) {
    if (!series.legend.empty()) legend.push_back({series.legend, series.style, series.is_line, false, series.marker});
  }
  const double legend_y = layout.is_narrow ? draw_narrow_title(nullptr, title_) + 12 : 50;
  const double legend_height = layout.is_narrow
                                   ? draw_narrow_legend(nullptr, {0, 0}, layout.width, legend)
                                   : draw_legend(nullptr, {kSideMargin, 0}, layout.width - 2 * kSideMargin, legend);
  const DrawingPoint centre{layout.width / 2, legend_y + legend_height + (layout.is_narrow ? 20 : 16) + layout.radius};
  SvgDrawing drawing(layout.width, centre.y + layout.radius + kMargin, title_);
  if (layout.is_narrow) {
    draw_narrow_title(&drawing, title_);
    draw_narrow_legend(&drawing, {0, legend_y}, layout.width, legend);
  } else {
    drawing.text({kSideMargin, 27}, title_, TextAnchor::start, 16, PlotColour::ink, true);
    draw_legend(&drawing, {kSideMargin, legend_y}, layout.width - 2 * kSideMargin, legend);
  }

  const AxisTicks ticks = this->ticks(layout.divisions);
  const auto radius_of = [&](double value) {
    return layout.radius * (value - ticks.from()) / (ticks.to() - ticks.from());
  };
  const auto at = [&](double angle, double radius) {
    return DrawingPoint{centre.x + radius * std::cos(angle), centre.y - radius * std::sin(angle)};
  };
  for (int i = 0; i < 12; ++i) {
    const double angle = i * std::numbers::pi / 6;
    drawing.line(centre, at(angle, layout.radius), kPolarGrid);
    if (i % 3 != 0) continue;
    const DrawingPoint name = at(angle, layout.radius + 16);
    const TextAnchor anchor = i == 0 ? TextAnchor::start : i == 6 ? TextAnchor::end : TextAnchor::middle;
    drawing.text({name.x + (i == 0   ? -6
                            : i == 6 ? 6
                                     : 0),
                  name.y + (i == 9   ? 8
                            : i == 3 ? 2
                                     : 4)},
                 names_[i / 3], anchor, layout.is_narrow ? 12 : 13);
  }
  for (const double value : ticks.values) {
    drawing.circle(centre, radius_of(value), value == 0 ? kZero : kPolarGrid);
  }
  for (const Series& series : series_) {
    std::vector<DrawingPoint> points;
    points.reserve(series.points.size() + 1);
    for (const PolarPoint& point : series.points) points.push_back(at(point.angle_rad, radius_of(point.value)));
    if (!series.is_line) {
      for (const DrawingPoint& point : points) drawing.marker(point, series.marker, series.style);
      continue;
    }
    if (series.closed && !points.empty()) points.push_back(points.front());
    drawing.polyline(points, series.style);
  }
  for (const Circle& circle : circles_) {
    drawing.circle(centre, radius_of(circle.value), circle.style);
    const DrawingPoint name = at(0.75 * std::numbers::pi, radius_of(circle.value));
    drawing.text({name.x - 4, name.y - 4}, circle.label, TextAnchor::end, 12, circle.style.colour);
  }
  // The scale last, over the lines, between the directions of the axes. Where circles are closer than their numbers are
  // wide, every n-th has one, counted from zero.
  double widest = 0;
  for (const std::string& label : ticks.labels) widest = std::max(widest, text_width(label, layout.scale_size));
  const double apart = layout.radius * std::cos(std::numbers::pi / 12) / static_cast<double>(ticks.values.size() - 1);
  const auto every = static_cast<std::size_t>(std::max(1.0, std::ceil((widest + 4) / apart)));
  const auto zero = std::find(ticks.values.begin(), ticks.values.end(), 0.0);
  const auto first = static_cast<std::size_t>(zero == ticks.values.end() ? 0 : zero - ticks.values.begin()) % every;
  for (std::size_t i = first; i < ticks.values.size(); i += every) {
    const DrawingPoint label = at(std::numbers::pi / 12, radius_of(ticks.values[i]));
    drawing.text({label.x + 2, label.y + 4}, ticks.labels[i], TextAnchor::start, layout.scale_size, PlotColour::soft);
  }
  drawing.text({centre.x, centre.y + layout.radius + 42}, value_label_, TextAnchor::middle, layout.is_narrow ? 12 : 13);
  return drawing.svg();
}

}  // namespace abbe
