#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>

#include "abbe/machine/machine.h"

namespace abbe {

/// Commands in chain order, [axes], in mm and rad as position_words() states them: {"C_deg": 30, "X_mm": 1.5}.
nlohmann::ordered_json position_json(const Machine& machine, std::span<const double> commands);

}  // namespace abbe
