#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/formats/machine/errors_file.h"

namespace abbe {

/// "errors taken at ambient_degC = 26.5", a line with its end; empty: they depend on no state that was given.
std::string state_line(const StateValues& at_state);

/// Adds at_state: {"ambient_degC": 26.5}, if there is any.
void add_state(const StateValues& at_state, nlohmann::ordered_json& json);

}  // namespace abbe
