#pragma once

#include <nlohmann/json_fwd.hpp>

#include "abbe/verify/error_map.h"
#include "abbe/verify/evaluations/statistics.h"

namespace abbe {

/// Statistics of lengths in mm as the report writes them, in um.
nlohmann::ordered_json statistics_um(const SampleStatistics& statistics);
/// Statistics of angles in rad, in urad.
nlohmann::ordered_json statistics_urad(const SampleStatistics& statistics);

/// Angle between the actual and the nominal orientation over the covered poses of a map, rad.
SampleStatistics orientation_statistics(const ErrorMap& map);

/// The same as the report writes it, in urad.
nlohmann::ordered_json orientation_urad(const ErrorMap& map);

}  // namespace abbe
