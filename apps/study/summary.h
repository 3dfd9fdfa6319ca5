#pragma once

#include <nlohmann/json.hpp>

#include "study/job.h"

namespace abbe {

/// summary.json of a study: the headline figures, see docs/report-data.md.
nlohmann::ordered_json study_summary(const Study& study, const StudyResult& result);

/// Statistics of lengths in mm as the report writes them, in um.
nlohmann::ordered_json statistics_um(const SampleStatistics& statistics);

/// The verdict in one sentence.
std::string study_verdict(const Study& study, const StudyResult& result);

}  // namespace abbe
