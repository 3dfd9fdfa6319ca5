#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "abbe/machine/machine.h"

namespace abbe {

/// "C 30 deg, X 1.5 mm" of commands in chain order, [axes], in mm and rad; those behind the last axis are passed over.
/// @param number  how fmt writes the numbers, in mm and degrees
std::string position_words(const Machine& machine, std::span<const double> commands, const char* number = "{:.6g}");

/// The same as {"C_deg": 30, "X_mm": 1.5}.
nlohmann::ordered_json position_json(const Machine& machine, std::span<const double> commands);

}  // namespace abbe
