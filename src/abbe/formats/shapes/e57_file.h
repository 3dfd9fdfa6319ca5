#pragma once

// Internal to formats: point clouds of laser scanners, ASTM E2807.
#include <optional>
#include <string>
#include <string_view>

#include "abbe/formats/shapes/point_cloud_file.h"

namespace abbe {

/// True if the contents begin like an E57 file.
bool is_e57(std::string_view contents);

/// Reads E57 (.e57): the points of all scans in the frame of the file, one scan after the other, with the normals of
/// the extension for surface normals. Points that the file marks as invalid, or whose coordinates are not finite, are
/// left out and counted. The unit is the metre, by the standard.
///
/// Source: ASTM E2807-11, Standard Specification for 3D Imaging Data Exchange, Version 1.0; D. Huber, "The ASTM E57
/// File Format for 3D Imaging Data Exchange", Proc. SPIE 7864A (2011).
/// @throws InputError
PointCloudFile parse_e57(std::string_view contents, const std::string& file, const std::optional<FileLength>& unit = {},
                         int threads = 0);

}  // namespace abbe
