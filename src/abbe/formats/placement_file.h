#pragma once

#include <filesystem>
#include <string>

#include "abbe/machine/placement.h"

namespace abbe {

/// Placement of a workpiece from a `*.placement.toml` file: translation_mm, angles_deg of Rx Ry Rz, and which way they
/// map. @throws InputError
Placement read_placement(const std::filesystem::path& path);
/// @param file  name for messages
Placement parse_placement(const std::string& text, const std::string& file);

/// Text of such a file in the reading "table-to-workpiece" (p_W = D p_B) or "workpiece-to-table"; standard
/// uncertainties as comments.
std::string placement_text(const Placement& placement, bool table_to_workpiece);

}  // namespace abbe
