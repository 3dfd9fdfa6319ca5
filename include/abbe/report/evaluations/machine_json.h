#pragma once

#include <nlohmann/json_fwd.hpp>

#include "abbe/machine/machine.h"

namespace abbe {

/// A machine as pages hold it: the `machine` section of docs/report-data.md, units in the keys.
nlohmann::ordered_json report_machine(const Machine& machine);

/// What every description of an axis begins with: name, kind, side, sense, direction and point; units in the keys.
nlohmann::ordered_json axis_json(const Axis& axis);

/// Adds what its position contains of commands of other axes, by the keys of a machine file; nothing if it is none.
void add_couplings(const Machine& machine, std::size_t axis, nlohmann::ordered_json& json);

/// Four significant digits, for numbers that are only drawn; 0 for what is not finite.
double for_drawing(double value);

}  // namespace abbe
