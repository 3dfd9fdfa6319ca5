#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/study/study_result.h"

namespace abbe {

/// The `identification` section: rank, gauge, convergence, stages, choice of orders.
nlohmann::ordered_json report_identification(const Study& study, const StudyResult& result);

/// What a reader must know to use the figures: model, noise, gauge, limits of validity. One sentence each.
std::vector<std::string> report_assumptions(const Study& study, const StudyResult& result);

}  // namespace abbe
