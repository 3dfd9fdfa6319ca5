#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/formats/nc/path_program.h"
#include "abbe/plan/scans/scan_plan.h"

namespace abbe {

/// CSV of a plan: time_s, the axis commands (X_mm, C_deg), measures (0 or 1), blocked (1: no clear way was found
/// for this move), face, line, then point and beam in the workpiece frame (x_mm, y_mm, z_mm, i, j, k).
std::string scan_plan_csv(const Machine& machine, const ScanPlan& plan);

/// NC program (RS-274): linear interpolation of all axes, mm and degrees, inverse time feed (G93), a comment per line;
/// M0, which stops the machine until the operator goes on, before ways that are not clear.
/// @param title    one line for the first comment
/// @param options  decimals and the words of axes whose names have numbers
std::string scan_plan_program(const Machine& machine, const ScanPlan& plan, const std::string& title,
                              const PathProgramOptions& options = {});

/// Colour of what became of a place (red, green, blue): green where it is covered, one of its own for every cause.
std::array<std::uint8_t, 3> scan_obstacle_colour(ScanObstacle obstacle);

/// Binary PLY of places of the surface in the frame of the part: colour, face (from 0) and obstacle (a number of
/// ScanObstacle, 0 where it is covered).
std::string scan_coverage_ply(const ScanPlan& plan);

/// Figures of a plan and of its faces, as `abbe scan plan --json` prints them; docs/scan.md.
nlohmann::ordered_json scan_plan_summary(const Machine& machine, const ScanPlan& plan, const std::string& part);

}  // namespace abbe
