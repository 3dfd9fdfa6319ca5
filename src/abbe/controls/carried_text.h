#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/verify/table_loss.h"

namespace abbe {

/// mm or rad in um or urad: "12.30 um".
std::string micro_words(double value, bool is_angle);

/// A line for each error: its size, what becomes of it in a word, its shift (and turn) before and after.
std::string carried_errors_lines(const std::vector<CarriedError>& errors);

/// One error of those lines; units in the keys.
nlohmann::ordered_json carried_error_json(const CarriedError& error);

/// A line with mean, 95 % and maximum of shift and turn.
std::string deviations_line(const char* name, const PoseDeviations& deviations);

/// The same for programs.
nlohmann::ordered_json deviations_json(const PoseDeviations& deviations);

}  // namespace abbe
