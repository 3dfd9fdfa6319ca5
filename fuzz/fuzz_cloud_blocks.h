#pragma once

#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "abbe/formats/shapes/point_cloud_blocks.h"
#include "abbe/formats/text/input_error.h"

/// A cloud that is read in blocks of a few points has the points that it has as a whole, or is refused.
/// @param as_strict  what is refused as a whole is refused in blocks, and the other way round
inline void require_same_in_blocks(std::string_view contents, const std::string& file, bool as_strict) {
  abbe::PointCloudOptions options;
  options.threads = 1;
  std::optional<abbe::PointCloudFile> whole;
  try {
    whole = abbe::parse_point_cloud(contents, file, options);
  } catch (const abbe::InputError&) {
  }
  Eigen::Index count = 0;
  std::size_t not_finite = 0;
  try {
    if (!abbe::point_cloud_kind(contents, file).in_blocks) return;
    const abbe::PointCloudBlocks blocks(contents, file, options);
    for (std::size_t from = blocks.begin(); from < blocks.end();) {
      const std::size_t to = blocks.block_end(from, 3);
      if (to <= from || to > blocks.end()) std::abort();
      const abbe::CloudBlock block = blocks.read(from, to, 1);
      if (!block.points.allFinite()) std::abort();
      if (whole) {
        if (count + block.points.cols() > whole->cloud.points.cols()) std::abort();
        if (block.points != whole->cloud.points.middleCols(count, block.points.cols())) std::abort();
      }
      count += block.points.cols();
      not_finite += block.not_finite;
      from = to;
    }
  } catch (const abbe::InputError&) {
    if (whole && as_strict) std::abort();
    return;
  }
  if (whole && (count != whole->cloud.points.cols() || not_finite != whole->left_out)) std::abort();
}
