#pragma once

#include <string>

#include "abbe/machine/inverse_plan.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// "C2_deg=30": an axis and its command, mm or rad. Whether it lies within the travel is not looked at.
/// @param option  how the user calls it, for the error: "--hold"
/// @throws InputError
HeldAxis axis_option(const Machine& machine, const std::string& option, const std::string& text);

}  // namespace abbe
