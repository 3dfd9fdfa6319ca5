#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/file_unit.h"
#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// What a PLY file holds of a point cloud or a mesh; other elements and properties are passed over.
struct PlyContents {
  Eigen::Matrix3Xd points;   ///< [3, n] mm
  Eigen::Matrix3Xd normals;  ///< [3, n] unit vectors, or [3, 0]
  Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic> triangles;
  bool has_faces = false;  ///< there is an element "face", perhaps without any
  std::string format;      ///< "PLY, binary little-endian"
  FileUnit unit;
};

/// True if the contents begin like a PLY file.
bool is_ply(std::string_view contents);

/// Reads PLY, ascii or binary of either byte order, with properties of any type; polygons become triangles. A line
/// "comment unit mm" in the header states the unit. @throws InputError
PlyContents parse_ply(std::string_view contents, const std::string& file, const std::optional<FileLength>& unit = {});

/// What to write; arrays are as long as `points` has columns, or empty.
struct PlyParts {
  Eigen::Ref<const Eigen::Matrix3Xd> points;                 ///< [3, n] mm
  Eigen::Matrix3Xd normals{};                                ///< [3, n] or [3, 0]
  Eigen::Matrix<std::uint8_t, 3, Eigen::Dynamic> colours{};  ///< [3, n] red, green, blue, or [3, 0]
  std::span<const double> deviation{};                       ///< [n] mm, written as deviation_mm, or empty
  Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic> triangles{};
};

/// Binary little-endian PLY with double coordinates, which read back to the same bits, and "comment unit mm".
std::string ply_bytes(const PlyParts& parts);

/// The same in pieces: what stands in front of the points, and rows of some of them.
/// @param parts  what the points have; their number does not count @param points  number of all
std::string ply_header(const PlyParts& parts, Eigen::Index points);
std::string ply_rows(const PlyParts& parts);

}  // namespace abbe
