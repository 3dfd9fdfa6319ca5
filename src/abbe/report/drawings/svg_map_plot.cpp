#include "abbe/report/drawings/svg_map_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

#include "abbe/report/drawings/svg_drawing.h"
#include "abbe/report/drawings/svg_plot.h"

namespace abbe {
namespace {

constexpr double kMapWidth = 860, kMapGap = 78, kMapLeft = 66, kMapTitle = 44, kMapLabels = 50, kScaleHeight = 58;
constexpr double kFaintest = 0.04;

DrawingPoint shifted(DrawingPoint at, double dx, double dy) { return {at.x + dx, at.y + dy}; }

void draw_cell(SvgDrawing& drawing, DrawingPoint corner, double width, double height, double share) {
  const std::array<DrawingPoint, 4> corners = {corner, shifted(corner, width, 0), shifted(corner, width, height),
                                               shifted(corner, 0, height)};
  const double opacity = kFaintest + (1 - kFaintest) * std::abs(share);
  drawing.area(corners, {share < 0 ? PlotColour::second : PlotColour::first, 1, false, opacity});
}

}  // namespace

struct MapPlot::Layout {
  bool is_narrow = false;
  double width = kMapWidth, left = kMapLeft, right = 20, scale_size = 11;
  std::size_t panels_per_row = 2;
};

MapPlot::MapPlot(std::string title, Axis x, Axis y, std::string value_label)
    : title_(std::move(title)), value_label_(std::move(value_label)), x_(std::move(x)), y_(std::move(y)) {
  assert(x_.count >= 2 && y_.count >= 2);
}

void MapPlot::add(MapPanel panel) {
  assert(panel.values.size() == x_.count * y_.count);
  panels_.push_back(std::move(panel));
}

std::string MapPlot::svg() const { return drawn({}); }

SvgPicture MapPlot::picture() const { return {svg(), drawn({true, kNarrowWidth, 54, 14, 12, 1})}; }

std::string MapPlot::drawn(const Layout& layout) const {
  const std::size_t in_row = std::clamp<std::size_t>(panels_.size(), 1, layout.panels_per_row);
  const std::size_t rows = (panels_.size() + layout.panels_per_row - 1) / layout.panels_per_row;
  const double share =
      (layout.width - layout.left - layout.right) / static_cast<double>(in_row) - (in_row > 1 ? kMapGap / 2 : 0);
  // Whole pixels, so that no seams show between cells; a narrow drawing may have fewer pixels than cells.
  const double whole = std::floor(share / static_cast<double>(x_.count));
  const double cell = whole < 1 && layout.is_narrow ? share / static_cast<double>(x_.count) : std::max(1.0, whole);
  const double width = cell * static_cast<double>(x_.count);
  const double tall = std::max(1.0, std::floor(0.62 * width / static_cast<double>(y_.count)));
  const double height = tall * static_cast<double>(y_.count);
  // Narrow: the name of the second axis is above the panel, that of the values below their scale.
  std::size_t title_lines = 1;
  const auto lines_of_title = [&](const MapPanel& panel) {
    return layout.is_narrow ? text_lines(panel.title, layout.width / 1.08, 13) : std::vector<std::string>{panel.title};
  };
  for (const MapPanel& panel : panels_) title_lines = std::max(title_lines, lines_of_title(panel).size());
  const double above = layout.is_narrow ? 24 + 16 * static_cast<double>(title_lines) : 24,
               below = layout.is_narrow ? kScaleHeight + 2 : kScaleHeight;
  const double title = layout.is_narrow ? draw_narrow_title(nullptr, title_) + 8 : kMapTitle;
  const double panel_height = above + height + kMapLabels + below;
  SvgDrawing drawing(layout.width, title + panel_height * static_cast<double>(rows), title_);
  if (layout.is_narrow) {
    draw_narrow_title(&drawing, title_);
  } else {
    drawing.text({kMapLeft, 27}, title_, TextAnchor::start, 16, PlotColour::ink, true);
  }
  const auto tick = [](double value) { return fmt::format("{:.4g}", value); };
  for (std::size_t k = 0; k < panels_.size(); ++k) {
    const MapPanel& panel = panels_[k];
    const double left = layout.left + static_cast<double>(k % layout.panels_per_row) * (width + kMapGap);
    const double top = title + (above - 4) + static_cast<double>(k / layout.panels_per_row) * panel_height;
    const double bottom = top + height;
    double title_y = top - above + 17;
    for (const std::string& line : lines_of_title(panel)) {
      drawing.text({layout.is_narrow ? 0 : left, title_y}, line, TextAnchor::start, 13, PlotColour::ink, true);
      title_y += 16;
    }
    double largest = 0;
    bool negative = false;
    for (const double value : panel.values) {
      if (!std::isfinite(value)) continue;
      largest = std::max(largest, std::abs(value));
      negative = negative || value < 0;
    }
    for (std::size_t j = 0; j < y_.count; ++j) {
      for (std::size_t i = 0; i < x_.count; ++i) {
        const double value = panel.values[j * x_.count + i];
        if (!std::isfinite(value)) continue;
        draw_cell(drawing, {left + cell * static_cast<double>(i), bottom - tall * static_cast<double>(j + 1)}, cell,
                  tall, largest > 0 ? value / largest : 0);
      }
    }
    for (const double end : {0.0, 0.5, 1.0}) {
      const double across = left + cell / 2 + end * (width - cell), up = bottom - tall / 2 - end * (height - tall);
      drawing.line({across, bottom}, {across, bottom + 4}, {PlotColour::soft, 1});
      drawing.text({across, bottom + 18}, tick(x_.from + end * (x_.to - x_.from)), TextAnchor::middle, 12,
                   PlotColour::soft);
      drawing.line({left - 4, up}, {left, up}, {PlotColour::soft, 1});
      drawing.text({left - 8, up + 4}, tick(y_.from + end * (y_.to - y_.from)), TextAnchor::end, 12, PlotColour::soft);
    }
    drawing.text({left + width / 2, bottom + 36}, x_.label, TextAnchor::middle, 12);
    if (layout.is_narrow) {
      drawing.text({0, top - 8}, y_.label);
    } else if (k % layout.panels_per_row == 0) {
      drawing.text({16, (top + bottom) / 2}, y_.label, TextAnchor::middle, 12, PlotColour::ink, false, -90);
    }
    constexpr int kSteps = 20;
    const double scale_top = bottom + kMapLabels, step = std::floor(0.7 * width / kSteps);
    const double from = negative ? -1 : 0;
    for (int s = 0; s < kSteps; ++s) {
      draw_cell(drawing, {left + step * s, scale_top}, step, 12, from + (1 - from) * (s + 0.5) / kSteps);
    }
    drawing.text({left, scale_top + 26}, tick(from * largest), TextAnchor::start, layout.scale_size, PlotColour::soft);
    drawing.text({left + step * kSteps, scale_top + 26}, tick(largest), TextAnchor::end, layout.scale_size,
                 PlotColour::soft);
    const DrawingPoint name =
        layout.is_narrow ? DrawingPoint{left, scale_top + 43} : DrawingPoint{left + step * kSteps + 8, scale_top + 11};
    drawing.text(name, value_label_, TextAnchor::start, layout.scale_size);
  }
  return drawing.svg();
}

}  // namespace abbe
