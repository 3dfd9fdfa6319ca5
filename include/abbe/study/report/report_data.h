#pragma once

#include <nlohmann/json_fwd.hpp>

#include "abbe/study/study_result.h"

namespace abbe {

/// Data of the report page of a study: docs/report-data.md.
nlohmann::ordered_json study_report_data(const Study& study, const StudyResult& result,
                                         const nlohmann::ordered_json& summary);

/// The `map` section from at most `limit` poses; the rest is thinned out evenly.
/// @param after  may be null
nlohmann::ordered_json report_map(const Machine& machine, const PoseList& poses, const ErrorMap& before,
                                  const ErrorMap* after, const ErrorMap* uncertainty, const std::string& description,
                                  std::size_t limit = 3000);

}  // namespace abbe
