#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/study/planning/planning.h"

namespace abbe {

/// Data of the page of a plan (docs/report-data.md): figures, uncertainty over the number of readings, comparison with
/// grids, the chosen poses as the machine takes them, what is not determined, and the readings.
/// @param plan  done
nlohmann::json plan_page_data(const Study& study, const StudyPlan& plan);

/// The page itself, HTML.
std::string plan_page(const Study& study, const StudyPlan& plan);

}  // namespace abbe
