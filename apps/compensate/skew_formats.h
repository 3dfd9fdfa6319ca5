#pragma once

#include "compensate/table_formats.h"

namespace abbe {

/// Printers: three angles between the axes.
TableFormat klipper_format();
TableFormat marlin_format();

}  // namespace abbe
