#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/file_unit.h"

namespace abbe {

/// What a Wavefront OBJ file holds of a point cloud or a mesh.
struct ObjContents {
  Eigen::Matrix3Xd points;   ///< [3, n] mm
  Eigen::Matrix3Xd normals;  ///< [3, n] unit vectors where the file has one "vn" for each "v" and no faces; or [3, 0]
  Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic> triangles;
  FileUnit unit;
  /// Of files with lines "o", "g" or "usemtl": each combination of object, group and material is a region; else empty.
  std::vector<std::uint32_t> region_of_triangle;  ///< [triangles] numbered in the order of their first triangles
  std::vector<std::string> regions;               ///< their names: "object / group / material"
};

/// Reads OBJ: v, vn, f with corners a, a/b, a//c, a/b/c, counted from 1 or backwards from -1; polygons become
/// triangles. Texture coordinates, points and lines are passed over; free-form surfaces are refused.
/// In parallel; the result does not depend on the number of threads. @throws InputError
ObjContents parse_obj(std::string_view contents, const std::string& file, const std::optional<FileLength>& unit = {},
                      int threads = 0);

}  // namespace abbe
