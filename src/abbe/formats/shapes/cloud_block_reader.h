#pragma once

// Internal to formats: readers of point clouds in blocks.
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "abbe/formats/shapes/pcd_header.h"
#include "abbe/formats/shapes/ply_header.h"
#include "abbe/formats/shapes/point_cloud_blocks.h"

namespace abbe {

class PointCloudBlocks::Reader {
 public:
  virtual ~Reader() = default;
  virtual std::size_t block_end(std::size_t from, std::size_t points) const = 0;
  virtual std::size_t about_points() const = 0;
  virtual std::size_t count(std::size_t from, std::size_t to, int threads) const = 0;
  virtual CloudBlock read(std::size_t from, std::size_t to, int threads) const = 0;

  std::string format;
  FileUnit unit;
  std::size_t begin = 0, end = 0;
};

/// Index of the element with the points of a binary PLY file whose points all take the same room, at a place that the
/// header tells; nothing for others.
std::optional<std::size_t> ply_vertices_in_blocks(const PlyHeader& header);

std::unique_ptr<const PointCloudBlocks::Reader> ply_block_reader(std::string_view contents, std::string file,
                                                                 const PointCloudOptions& options);
std::unique_ptr<const PointCloudBlocks::Reader> pcd_block_reader(std::string_view contents, std::string file,
                                                                 const PointCloudOptions& options);
std::unique_ptr<const PointCloudBlocks::Reader> csv_block_reader(std::string_view contents, std::string file,
                                                                 const PointCloudOptions& options);
std::unique_ptr<const PointCloudBlocks::Reader> xyz_block_reader(std::string_view contents, std::string file,
                                                                 const PointCloudOptions& options);

}  // namespace abbe
