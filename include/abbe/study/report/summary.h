#pragma once

#include <nlohmann/json_fwd.hpp>

#include "abbe/study/study_result.h"

namespace abbe {

/// summary.json of a study: the headline figures, see docs/report-data.md.
nlohmann::ordered_json study_summary(const Study& study, const StudyResult& result);

/// What the predicted uncertainty covers, if not everything: "identified errors only", "directions that the readings
/// determine only", or both; else empty.
std::string prediction_covers(const StudyResult& result);

/// The verdict in one sentence.
std::string study_verdict(const Study& study, const StudyResult& result);

}  // namespace abbe
