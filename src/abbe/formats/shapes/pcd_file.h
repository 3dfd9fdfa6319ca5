#pragma once

// Internal to formats: point clouds of the Point Cloud Library.
#include <optional>
#include <string>
#include <string_view>

#include "abbe/formats/shapes/point_cloud_file.h"

namespace abbe {

/// Reads PCD (.pcd), version 0.5 to 0.7, as text, binary or compressed: x, y, z and normal_x, normal_y, normal_z; other
/// fields are passed over. Points whose coordinates are not all finite are left out and counted. See is_pcd().
/// Source: Point Cloud Library, "The PCD (Point Cloud Data) file format",
/// https://pointclouds.org/documentation/tutorials/pcd_file_format.html
/// @throws InputError
PointCloudFile parse_pcd(std::string_view contents, const std::string& file,
                         const std::optional<FileLength>& unit = {});

}  // namespace abbe
