#pragma once

#include <string>
#include <vector>

#include "abbe/controls/control_table.h"
#include "abbe/controls/table_format.h"

namespace abbe {

/// "AXIS=NAME" options; whether there are such axes is not looked at. @throws InputError
std::vector<ControlAxisName> axis_names_option(const TableFormat& format, const std::vector<std::string>& texts);

}  // namespace abbe
