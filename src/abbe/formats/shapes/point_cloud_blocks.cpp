#include "abbe/formats/shapes/point_cloud_blocks.h"

#include <utility>

#include "abbe/formats/files/file_extension.h"
#include "abbe/formats/shapes/cloud_block_reader.h"
#include "abbe/formats/shapes/e57_file.h"
#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/shapes/stl_file.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

enum class BlockFormat { none, ply, pcd, csv, xyz };

/// A table in a file with any name: its first line that is no comment begins with a letter or a quote.
bool begins_with_a_name(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view line = csv_next_line(text, at);
    const std::size_t first = line.find_first_not_of(" \t\r\xEF\xBB\xBF");
    if (first == std::string_view::npos || line[first] == '#' || line[first] == '/') continue;
    const char c = line[first];
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '"';
  }
  return false;
}

BlockFormat text_block_format(std::string_view contents, const std::string& extension) {
  // UTF-16, gzip and anything else that is no text.
  if (contents.substr(0, 4096).find('\0') != std::string_view::npos || contents.starts_with("\x1f\x8b")) {
    return BlockFormat::none;
  }
  return extension == ".csv" || begins_with_a_name(contents) ? BlockFormat::csv : BlockFormat::xyz;
}

BlockFormat block_format(std::string_view contents, const std::string& file) {
  const std::string extension = file_extension(file);
  if (is_ply(contents)) {
    return ply_vertices_in_blocks(parse_ply_header(contents, file)) ? BlockFormat::ply : BlockFormat::none;
  }
  if (is_e57(contents) || is_binary_stl(contents)) return BlockFormat::none;
  for (const char* other : {".e57", ".ply", ".obj", ".stl", ".gz"}) {
    if (extension == other) return BlockFormat::none;
  }
  if (extension == ".pcd" || is_pcd(contents)) {
    return parse_pcd_header(contents, file).form == PcdForm::binary ? BlockFormat::pcd : BlockFormat::none;
  }
  return text_block_format(contents, extension);
}

}  // namespace

PointCloudKind point_cloud_kind(std::string_view contents, const std::string& file) {
  switch (block_format(contents, file)) {
    case BlockFormat::none:
      return {};
    case BlockFormat::ply: {
      const PlyHeader header = parse_ply_header(contents, file);
      return {true, header.elements[*ply_vertices_in_blocks(header)].count};
    }
    case BlockFormat::pcd:
      return {true, parse_pcd_header(contents, file).points};
    default:
      return {true, std::nullopt};
  }
}

PointCloudBlocks::PointCloudBlocks(std::string_view contents, std::string file, const PointCloudOptions& options) {
  switch (block_format(contents, file)) {
    case BlockFormat::ply:
      reader_ = ply_block_reader(contents, std::move(file), options);
      break;
    case BlockFormat::pcd:
      reader_ = pcd_block_reader(contents, std::move(file), options);
      break;
    case BlockFormat::csv:
      reader_ = csv_block_reader(contents, std::move(file), options);
      break;
    case BlockFormat::xyz:
      reader_ = xyz_block_reader(contents, std::move(file), options);
      break;
    case BlockFormat::none:
      throw InputError({.file = file}, "a file of this kind is read as a whole, and it is too large for that",
                       "binary PLY, binary PCD, CSV or XYZ");
  }
}

PointCloudBlocks::~PointCloudBlocks() = default;
PointCloudBlocks::PointCloudBlocks(PointCloudBlocks&&) noexcept = default;
PointCloudBlocks& PointCloudBlocks::operator=(PointCloudBlocks&&) noexcept = default;

const std::string& PointCloudBlocks::format() const { return reader_->format; }
const FileUnit& PointCloudBlocks::unit() const { return reader_->unit; }
std::size_t PointCloudBlocks::begin() const { return reader_->begin; }
std::size_t PointCloudBlocks::end() const { return reader_->end; }
std::size_t PointCloudBlocks::block_end(std::size_t from, std::size_t points) const {
  return reader_->block_end(from, points);
}
std::size_t PointCloudBlocks::about_points() const { return reader_->about_points(); }
std::size_t PointCloudBlocks::count(std::size_t from, std::size_t to, int threads) const {
  return reader_->count(from, to, threads);
}
CloudBlock PointCloudBlocks::read(std::size_t from, std::size_t to, int threads) const {
  return reader_->read(from, to, threads);
}

}  // namespace abbe
