#include "abbe/study/scans/scan_pieces.h"

#include <algorithm>

namespace abbe {

ScanPieces::ScanPieces(const PointCloudBlocks& blocks, std::size_t block) : blocks_(blocks) {
  const std::size_t all = blocks.about_points(), most = block * kMost;
  points_of_piece_ = block * std::max<std::size_t>(1, (all + most - 1) / most);
  for (std::size_t points = points_of_piece_; points < all; points += points_of_piece_) {
    ends_.push_back(blocks.block_end(blocks.begin(), points));
  }
  if (all > 0) ends_.push_back(blocks.end());
  points_.resize(ends_.size());
}

std::uint64_t ScanPieces::first_point(std::size_t piece, int threads) {
  const std::lock_guard lock(mutex_);
  std::uint64_t number = 0;
  for (std::size_t before = 0; before < piece; ++before) {
    if (!points_[before]) points_[before] = blocks_.count(begin(before), end(before), threads);
    number += *points_[before];
  }
  return number;
}

void ScanPieces::set_points(std::size_t piece, std::uint64_t points) {
  const std::lock_guard lock(mutex_);
  points_[piece] = points;
}

}  // namespace abbe
