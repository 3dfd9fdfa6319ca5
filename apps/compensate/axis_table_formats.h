#pragma once

#include "compensate/table_formats.h"

namespace abbe {

/// Controls with tables of one axis's command.
TableFormat linuxcnc_format();
TableFormat siemens_cec_format();
TableFormat siemens_eec_format();

}  // namespace abbe
