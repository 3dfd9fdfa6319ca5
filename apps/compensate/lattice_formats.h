#pragma once

#include "compensate/table_formats.h"

namespace abbe {

/// Correction vectors over a grid of axis positions.
TableFormat lattice_csv_format();
TableFormat lattice_vtk_format();

}  // namespace abbe
