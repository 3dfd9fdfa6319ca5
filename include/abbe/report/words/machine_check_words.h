#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/machine/machine.h"

namespace abbe {

/// What a machine file says, for people: a drawing, the axes, the errors that it can have, remarks.
std::string machine_check_text(const Machine& machine);

/// The same for programs; units in the keys.
nlohmann::ordered_json machine_check_json(const Machine& machine);

}  // namespace abbe
