#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "abbe/machine/tool_path.h"

namespace abbe {

/// A curve on the workpiece with directions of the tool: CSV, or a program of straight moves (.ngc, .nc, .tap, .mpf).
/// Formats: docs/tool-path.md. @throws InputError
Curve read_curve(const std::filesystem::path& path, const Machine& machine);

/// CSV with columns x_mm, y_mm, z_mm, i, j, k; optional feed_mm_per_min, pierce_s, beam (0 or 1: on the way here) and
/// commands of axes that are set beforehand (C2_deg). @param file  name for messages
Curve parse_curve(std::string_view text, const std::string& file, const Machine& machine);

/// Blocks G0 and G1 with X Y Z I J K, F in mm/min, G4 P in s, M3 and M5, axes set beforehand as C2=30 (degrees) or C30.
/// Every word that would be misread is an error.
Curve parse_curve_program(std::string_view text, const std::string& file, const Machine& machine);

/// CSV as parse_curve() reads it, all digits: x_mm, y_mm, z_mm, i, j, k, feed_mm_per_min, beam.
/// Curves without axes set beforehand and without piercing only.
std::string curve_csv(const Curve& curve);

}  // namespace abbe
