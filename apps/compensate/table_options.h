#pragma once

#include <string>
#include <vector>

#include "abbe/controls/control_table.h"
#include "abbe/controls/table_format.h"
#include "abbe/machine/inverse_plan.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// "AXIS_unit=position" options. @throws InputError, also outside the travel
/// @param option  how the user calls them: "--at"
std::vector<HeldAxis> held_axes_option(const Machine& machine, const std::string& option,
                                       const std::vector<std::string>& texts);

/// "AXIS=NAME" options; whether there are such axes is not looked at. @throws InputError
std::vector<ControlAxisName> axis_names_option(const TableFormat& format, const std::vector<std::string>& texts);

}  // namespace abbe
