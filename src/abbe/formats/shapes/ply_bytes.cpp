#include <fmt/format.h>

#include <cassert>
#include <cstring>

#include "abbe/formats/shapes/ply_file.h"

namespace abbe {
namespace {

template <typename T>
char* put(char* at, const T& value) {
  std::memcpy(at, &value, sizeof value);
  return at + sizeof value;
}

std::size_t row_bytes(const PlyParts& parts) {
  return 24 + (parts.normals.cols() > 0 ? 24U : 0U) + (parts.colours.cols() > 0 ? 3U : 0U) +
         (parts.deviation.empty() ? 0U : 8U);
}

char* put_rows(const PlyParts& parts, char* at) {
  const Eigen::Index n = parts.points.cols();
  const bool normals = parts.normals.cols() > 0, colours = parts.colours.cols() > 0,
             deviation = !parts.deviation.empty();
  assert(!normals || parts.normals.cols() == n);
  assert(!colours || parts.colours.cols() == n);
  assert(!deviation || parts.deviation.size() == static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < 3; ++k) at = put(at, parts.points(k, i));
    for (Eigen::Index k = 0; normals && k < 3; ++k) at = put(at, parts.normals(k, i));
    for (Eigen::Index k = 0; colours && k < 3; ++k) at = put(at, parts.colours(k, i));
    if (deviation) at = put(at, parts.deviation[static_cast<std::size_t>(i)]);
  }
  return at;
}

}  // namespace

std::string ply_header(const PlyParts& parts, Eigen::Index points) {
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment unit mm\n";
  header += fmt::format("element vertex {}\nproperty double x\nproperty double y\nproperty double z\n", points);
  if (parts.normals.cols() > 0) header += "property double nx\nproperty double ny\nproperty double nz\n";
  if (parts.colours.cols() > 0) header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (!parts.deviation.empty()) header += "property double deviation_mm\n";
  if (parts.triangles.cols() > 0) {
    header += fmt::format("element face {}\nproperty list uchar uint vertex_indices\n", parts.triangles.cols());
  }
  return header + "end_header\n";
}

std::string ply_rows(const PlyParts& parts) {
  std::string bytes(row_bytes(parts) * static_cast<std::size_t>(parts.points.cols()), '\0');
  put_rows(parts, bytes.data());
  return bytes;
}

std::string ply_bytes(const PlyParts& parts) {
  const Eigen::Index n = parts.points.cols();
  const std::string header = ply_header(parts, n);
  std::string bytes(header.size() + row_bytes(parts) * static_cast<std::size_t>(n) +
                        13 * static_cast<std::size_t>(parts.triangles.cols()),
                    '\0');
  std::memcpy(bytes.data(), header.data(), header.size());
  char* at = put_rows(parts, bytes.data() + header.size());
  for (Eigen::Index i = 0; i < parts.triangles.cols(); ++i) {
    at = put(at, std::uint8_t{3});
    for (Eigen::Index k = 0; k < 3; ++k) at = put(at, parts.triangles(k, i));
  }
  return bytes;
}

}  // namespace abbe
