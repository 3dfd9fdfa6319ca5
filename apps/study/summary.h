#pragma once

#include <nlohmann/json_fwd.hpp>

#include "study/job.h"

namespace abbe {

/// summary.json of a study: the headline figures, see docs/report-data.md.
nlohmann::ordered_json study_summary(const Study& study, const StudyResult& result);

/// Statistics of lengths in mm as the report writes them, in um.
nlohmann::ordered_json statistics_um(const SampleStatistics& statistics);
/// Statistics of angles in rad, in urad.
nlohmann::ordered_json statistics_urad(const SampleStatistics& statistics);

/// Angle between the actual and the nominal orientation over the covered poses of a map, rad.
SampleStatistics orientation_statistics(const ErrorMap& map);

/// The same as the report writes it, in urad.
nlohmann::ordered_json orientation_urad(const ErrorMap& map);

/// What the predicted uncertainty covers, if not everything: "identified errors only", "directions that the readings
/// determine only", or both; else empty.
std::string prediction_covers(const StudyResult& result);

/// The verdict in one sentence.
std::string study_verdict(const Study& study, const StudyResult& result);

}  // namespace abbe
