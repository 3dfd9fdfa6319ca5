#pragma once

#include <array>
#include <string>
#include <vector>

#include "reproduce_output.h"
#include "wang/integrated.h"
#include "wang/study.h"

namespace abbe {

/// One way to choose the 36 machining points of Figure 13. The paper shows them in a picture only: neither coordinates
/// nor commands are printed.
struct WangPoints {
  std::string name;                          ///< "circle"
  std::string words;                         ///< what they are
  WangMap degrees, millidegrees, no_angles;  ///< Figure 14: E at them, by how the angles of the tables are read
};

/// The 36 points in three readings: 10 degree steps of a circle as a ball bar runs it; the 12 printed positions of X, Y
/// and Z, the other axes at zero; 6 x 6 positions of X and Y.
std::vector<WangPoints> wang_points();

/// Mean |E| over the grid of wang_grid_map() with the points of tool and workpiece at so many times their distance from
/// their axes.
struct WangSize {
  double factor = 1;
  double degrees = 0, millidegrees = 0, no_angles = 0;  ///< mm
};
/// At half, once and twice the size.
std::vector<WangSize> wang_sizes();

/// What conclusions (1) to (3) say, and what the tables give, over all poses of the 11 measured positions.
struct WangConclusions {
  /// Mean |E| over all poses: complete, by the angles only, by the displacements only, mm.
  double complete_degrees = 0, complete_millidegrees = 0, angles_degrees = 0, angles_millidegrees = 0,
         displacements = 0;
  double largest_millidegrees = 0;  ///< |E| of all poses, mm
  double smallest_degrees = 0;      ///< least |E| of all poses, degrees as printed, mm
  double share_of_order_1_mm = 0;   ///< of the poses, degrees as printed: |E| from 0.32 to 3.2 mm
  std::vector<WangSize> sizes;
};

nlohmann::ordered_json wang_points_json(const std::vector<WangPoints>& points);
nlohmann::ordered_json wang_conclusions_json(const WangConclusions& conclusions);

/// The claim; three parts of a sentence: what the paper says, what the tables give, in which unit it holds.
std::vector<std::array<std::string, 4>> wang_conclusion_rows(const WangConclusions& conclusions);

/// The machining points with their commands and E, which only files and the page show.
ReproducedTable wang_point_table(const std::vector<WangPoints>& points);
/// Figures 13 and 14.
std::vector<EvaluationPlot> wang_point_plots(const std::vector<WangPoints>& points);

}  // namespace abbe
