#pragma once

#include "compensate/table_formats.h"

namespace abbe {

/// Controls with a kinematic model of ISO 230-1, which take the errors themselves.
TableFormat beckhoff_format();
TableFormat etalon_format();

}  // namespace abbe
