#pragma once

#include <string>
#include <vector>

#include "abbe/report/drawings/svg_drawing.h"

namespace abbe {

/// One rectangle of coloured cells.
struct MapPanel {
  std::string title;
  std::vector<double> values;  ///< row by row from the lowest y on, each from the lowest x on; not finite: left empty
};

/// Values over a regular grid of two axes as coloured cells, several panels beside each other, as SVG text. Computes
/// nothing. Each panel has a scale of its own below it, from zero to its largest magnitude, so that a small remainder
/// is seen beside what it was before. Positive and negative values have colours of their own.
class MapPlot {
 public:
  /// Centres of the cells along an axis.
  struct Axis {
    std::string label;  ///< with its unit: "X in mm"
    double from = 0, to = 1;
    std::size_t count = 2;  ///< of cells, at least 2
  };

  /// @param value_label  with its unit: "error in um"
  MapPlot(std::string title, Axis x, Axis y, std::string value_label);

  /// @param panel  x.count * y.count values
  void add(MapPanel panel);

  /// For a file.
  std::string svg() const;
  /// For a page.
  SvgPicture picture() const;

 private:
  struct Layout;
  std::string drawn(const Layout& layout) const;

  std::string title_, value_label_;
  Axis x_, y_;
  std::vector<MapPanel> panels_;
};

}  // namespace abbe
