#pragma once

#include "compensate/table_formats.h"

namespace abbe {

/// Machine tool controls whose tables are documented in part.
TableFormat heidenhain_format();
TableFormat fanuc_pitch_format();

}  // namespace abbe
