#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "abbe/formats/shapes/point_cloud_file.h"

namespace abbe {

/// What can be told of a point cloud file without reading it.
struct PointCloudKind {
  bool in_blocks = false;               ///< PointCloudBlocks can read it
  std::optional<std::uint64_t> points;  ///< as the header states them; only if in_blocks
};

/// @param file  name for messages; its extension counts
/// @throws InputError for a damaged header of a PLY or PCD file
PointCloudKind point_cloud_kind(std::string_view contents, const std::string& file);

/// Points as read from a part of a file.
struct CloudBlock {
  Eigen::Matrix3Xd points;     ///< [3, n] mm, in the order of the file
  std::size_t not_finite = 0;  ///< left out (PCD): not all coordinates are finite numbers
};

/// A point cloud that is read in blocks, for files that do not fit into memory: binary PLY, binary PCD, CSV with a
/// header as Abbe writes it, and XYZ: lines of three numbers or six. All that parse_point_cloud() refuses of the
/// coordinates is refused here in the same words. Normals and other properties are passed over.
class PointCloudBlocks {
 public:
  /// Reads the header. @param contents  have to outlive the object
  /// @throws InputError also for a file that is shorter than its header says
  PointCloudBlocks(std::string_view contents, std::string file, const PointCloudOptions& options = {});
  ~PointCloudBlocks();
  PointCloudBlocks(PointCloudBlocks&&) noexcept;
  PointCloudBlocks& operator=(PointCloudBlocks&&) noexcept;

  const std::string& format() const;  ///< "PLY, binary little-endian"
  const FileUnit& unit() const;

  std::size_t begin() const;  ///< first byte with points
  std::size_t end() const;    ///< byte behind the last point
  /// Byte behind a block of about so many points that begins at `from`.
  std::size_t block_end(std::size_t from, std::size_t points) const;
  /// Points, about; of records those with coordinates that are not finite too.
  std::size_t about_points() const;
  /// Points that read() gives from one end of a block to another. Faster: their coordinates are not converted.
  std::size_t count(std::size_t from, std::size_t to, int threads = 0) const;
  /// Points from one end of a block to another. @param threads  0: all; the result does not depend on it
  /// @throws InputError
  CloudBlock read(std::size_t from, std::size_t to, int threads = 0) const;

  /// Internal: one kind of file.
  class Reader;

 private:
  std::unique_ptr<const Reader> reader_;
};

/// Bytes that a point takes in a text, about: for the number of points of a file that does not state it.
inline constexpr std::size_t kBytesOfPointInText = 27;

}  // namespace abbe
