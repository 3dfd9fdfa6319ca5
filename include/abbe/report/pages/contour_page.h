#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "abbe/verify/parts/contour_sections.h"

namespace abbe {

/// The block `contour` of the interactive page (docs/report-data.md): contour error along the curve, and the sections.
/// @param answers  [sections]
nlohmann::json contour_sections_block(const SectionOptions& options, const std::vector<SectionReadings>& sections,
                                      const std::vector<SectionAnswer>& answers);

/// The same for measured points, those beside the curve with a distance across it.
/// @param joined  they lie on one piece: a line may join them
nlohmann::json contour_points_block(const ContourPointsEvaluation& evaluated, bool joined);

}  // namespace abbe
