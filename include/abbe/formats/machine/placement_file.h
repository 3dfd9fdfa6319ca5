#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "abbe/machine/placement.h"

namespace abbe {

struct PlacementFile {
  Placement placement;
  std::vector<std::string> warnings{};  ///< what else there is to say of it, such as faces that the part lacked
};

/// Placement of a workpiece from a `*.placement.toml` file: translation_mm, angles_deg of Rx Ry Rz, which way they map,
/// and warnings. @throws InputError
PlacementFile read_placement(const std::filesystem::path& path);
/// @param file  name for messages
PlacementFile parse_placement(const std::string& text, const std::string& file);

/// Text of such a file in the reading "table-to-workpiece" (p_W = D p_B) or "workpiece-to-table"; standard
/// uncertainties as comments.
std::string placement_text(const PlacementFile& file, bool table_to_workpiece);

}  // namespace abbe
