#pragma once

#include <nlohmann/json_fwd.hpp>

#include "abbe/report/evaluations/evaluation_report.h"

namespace abbe {

/// An evaluation as data of the interactive page ("abbe-report/1"): title, block "evaluation" with facts, figures and
/// plots, notes as assumptions, tables; what `report.page` holds is added at the top level.
nlohmann::json evaluation_data(const EvaluationReport& report);

/// An entry of the drawings of that block.
nlohmann::json drawing_data(const EvaluationPlot& plot);

}  // namespace abbe
