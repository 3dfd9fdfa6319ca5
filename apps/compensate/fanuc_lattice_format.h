#pragma once

#include "compensate/table_formats.h"

namespace abbe {

/// Three-dimensional error compensation of FANUC.
TableFormat fanuc_lattice_format();

}  // namespace abbe
