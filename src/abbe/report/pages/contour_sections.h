#pragma once

#include <string>
#include <vector>

#include "abbe/report/drawings/svg_plot.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/parts/contour_sections.h"

namespace abbe {

/// For programs; units in the keys.
nlohmann::ordered_json section_json(const SectionReadings& section, const SectionAnswer& answer);

/// A row for each section; a groove has both of its edges.
EvaluationTable section_table(const std::vector<SectionReadings>& sections, const std::vector<SectionAnswer>& answers,
                              bool groove);

/// What a drawing of a section shows, um: across the curve, out of the surface.
struct SectionPicture {
  /// What was fitted to an edge.
  struct Edge {
    std::vector<PlotPoint> curve;  ///< from the surface through the rounding down the wall
    PlotPoint onset, corner;       ///< P1, P2
  };
  std::vector<PlotPoint> scanned;  ///< around the corners; all of a section without an answer
  std::vector<Edge> edges;         ///< none without an answer
};
SectionPicture section_picture(const SectionOptions& options, const SectionReadings& section,
                               const SectionAnswer& answer);

/// The same as a plot; of a section that was evaluated.
EvaluationPlot section_plot(const SectionOptions& options, const SectionReadings& section, const SectionAnswer& answer);

}  // namespace abbe
