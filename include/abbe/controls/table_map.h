#pragma once

#include "abbe/controls/control_table.h"
#include "abbe/formats/machine/map_file.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Deviations at ControlTables::poses before, with these tables and with the ideal correction, as a map for map_csv()
/// and map_vtk().
MapData control_table_map(const Machine& machine, const ControlTables& made);

}  // namespace abbe
