#pragma once

#include <nlohmann/json_fwd.hpp>

#include "abbe/identify/linkage/scanner_positioning.h"

namespace abbe {

/// Six positioning parameters with their standard uncertainties: x_mm, u_x_mm, ... gamma_deg, u_gamma_deg.
nlohmann::ordered_json position_json(const PositioningParameters& parameters);

}  // namespace abbe
