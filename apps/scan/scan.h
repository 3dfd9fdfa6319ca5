#pragma once

#include "command.h"

namespace abbe {

/// abbe scan points: axis positions and indications to points.
void add_scan_points(CLI::App& scan, CommandLine& line);

}  // namespace abbe
