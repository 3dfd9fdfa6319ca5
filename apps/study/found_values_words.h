#pragma once

#include <nlohmann/json_fwd.hpp>

#include "study/found_values.h"

namespace abbe {

struct Identification;

/// Prints the identified values with their expanded uncertainties.
/// @param all  every number of every set-up; else the first dozen of each
void print_found_values(const FoundValues& found, bool all);

/// The same for programs: `identified` of summary.json, see docs/report-data.md.
nlohmann::ordered_json found_values_json(const FoundValues& found);

/// The conventions of the gauge in a short table: what is set, and which parameters the readings do not tell apart.
void print_gauge_table(const Identification& identified);

/// The same for programs: `gauge` of summary.json.
nlohmann::ordered_json gauge_table_json(const Identification& identified);

}  // namespace abbe
