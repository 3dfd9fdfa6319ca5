#pragma once

#include <string>
#include <vector>

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

/// The scanned points around the corners with the fitted curve; of a section that was evaluated.
EvaluationPlot section_plot(const ContourRequest& request, const SectionReadings& section, const SectionAnswer& answer);

}  // namespace abbe
