#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/study/report/found_values.h"

namespace abbe {

struct Identification;

/// The identified values with their expanded uncertainties.
/// @param shows_all  option to be named where only the first dozen of a set-up are printed; null: every number
std::string found_values_text(const FoundValues& found, const char* shows_all);

/// The same for programs: `identified` of summary.json, see docs/report-data.md.
nlohmann::ordered_json found_values_json(const FoundValues& found);

/// The conventions of the gauge in a short table: what is set, and which parameters the readings do not tell apart.
std::string gauge_table_text(const Identification& identified);

/// The same for programs: `gauge` of summary.json.
nlohmann::ordered_json gauge_table_json(const Identification& identified);

}  // namespace abbe
