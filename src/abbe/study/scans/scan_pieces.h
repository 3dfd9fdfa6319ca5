#pragma once

// Internal to study: a scan in a file, in pieces that can be read in any order.
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "abbe/formats/shapes/point_cloud_blocks.h"

namespace abbe {

/// Pieces of about the same number of points, a whole number of blocks each, and at most kMost of them. The numbers of
/// their points are those of the whole scan.
class ScanPieces {
 public:
  static constexpr std::size_t kMost = 256;

  /// @param blocks  has to outlive the object @param block  points that are read at a time
  ScanPieces(const PointCloudBlocks& blocks, std::size_t block);

  std::size_t count() const { return ends_.size(); }
  std::size_t points_of_piece() const { return points_of_piece_; }  ///< about
  /// Bytes in the file.
  std::size_t begin(std::size_t piece) const { return piece == 0 ? blocks_.begin() : ends_[piece - 1]; }
  std::size_t end(std::size_t piece) const { return ends_[piece]; }

  /// Number of the first point of a piece. Counts the points of those in front that nobody has told. Several threads
  /// may call it at a time, as also set_points().
  std::uint64_t first_point(std::size_t piece, int threads);
  void set_points(std::size_t piece, std::uint64_t points);

 private:
  const PointCloudBlocks& blocks_;
  std::size_t points_of_piece_;
  std::vector<std::size_t> ends_;
  std::mutex mutex_;
  std::vector<std::optional<std::uint64_t>> points_;  // of each piece, as far as known
};

}  // namespace abbe
