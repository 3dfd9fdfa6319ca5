#pragma once

#include "abbe/compensate/program/command_correction.h"
#include "abbe/controls/control_table.h"

namespace abbe {

/// Fills in the largest corrections over ControlTables::poses, and refuses tables that would make the error larger and
/// corrections above the limits of the request.
void check_limits(const ControlTableRequest& request, const CommandCorrection& correction, ControlTables& made);

}  // namespace abbe
