#pragma once

#include <string>

#include "abbe/instruments/scan_plan.h"

namespace abbe {

/// CSV of a plan: time_s, the axis commands (X_mm, C_deg), measures (0 or 1), face, line, then point and beam in the
/// workpiece frame (x_mm, y_mm, z_mm, i, j, k).
std::string scan_plan_csv(const Machine& machine, const ScanPlan& plan);

/// NC program (RS-274): linear interpolation of all axes, mm and degrees, inverse time feed (G93), a comment per line.
/// @param title  one line for the first comment
std::string scan_plan_program(const Machine& machine, const ScanPlan& plan, const std::string& title);

/// Binary PLY of places of the surface in the frame of the part, green where they are covered, red where not.
std::string scan_coverage_ply(const ScanPlan& plan);

}  // namespace abbe
