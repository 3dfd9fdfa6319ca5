#pragma once

#include <string>
#include <vector>

#include "abbe/report/svg_plot.h"
#include "evaluate/contour_report.h"

namespace abbe {

/// What one section says.
struct SectionAnswer {
  bool groove = false;
  EdgeFit first, second;  ///< the edge, or the left and the right one of a groove
  bool ok = false;
  std::string reason;                       ///< why not
  double error = 0, error_uncertainty = 0;  ///< mm, signed, across the curve; standard
  double width = 0;                         ///< mm, of a groove

  std::vector<const EdgeFit*> edges() const;  ///< those that there are
};

SectionAnswer answer_of(const ContourRequest& request, const SectionReadings& section);

/// For programs; units in the keys.
nlohmann::ordered_json section_json(const SectionReadings& section, const SectionAnswer& answer);

/// A row for each section; a groove has both of its edges.
EvaluationTable section_table(const std::vector<SectionReadings>& sections, const std::vector<SectionAnswer>& answers,
                              bool groove);

/// Whether all sections say where on the curve they are; else their number stands for it.
bool along_is_stated(const std::vector<SectionReadings>& sections);

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
SectionPicture section_picture(const ContourRequest& request, const SectionReadings& section,
                               const SectionAnswer& answer);

/// The same as a plot; of a section that was evaluated.
EvaluationPlot section_plot(const ContourRequest& request, const SectionReadings& section, const SectionAnswer& answer);

}  // namespace abbe
