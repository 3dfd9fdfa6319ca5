#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "abbe/compensate/workpiece_expansion.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// "workpiece: 23.4 um/(m K), right at 20 degC and now at 26 degC, fixed at (0, 0, 0) mm", a line with its end.
/// @param coldest, warmest  degC
std::string workpiece_line(const WorkpieceExpansion& workpiece, double coldest, double warmest);

/// Adds the object "workpiece".
void add_workpiece(const Machine& machine, const WorkpieceExpansion& workpiece, double coldest, double warmest,
                   nlohmann::ordered_json& json);

/// The same for a workpiece at one temperature, with the uncertainties that are stated; nothing without a workpiece.
std::string workpiece_line(const std::optional<WorkpieceExpansion>& workpiece);
void add_workpiece(const std::optional<WorkpieceExpansion>& workpiece, nlohmann::ordered_json& json);

}  // namespace abbe
