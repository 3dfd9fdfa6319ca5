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

}  // namespace

std::string ply_bytes(const PlyParts& parts) {
  const Eigen::Index n = parts.points.cols();
  const bool normals = parts.normals.cols() > 0, colours = parts.colours.cols() > 0,
             deviation = !parts.deviation.empty();
  assert(!normals || parts.normals.cols() == n);
  assert(!colours || parts.colours.cols() == n);
  assert(!deviation || parts.deviation.size() == static_cast<std::size_t>(n));
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment unit mm\n";
  header += fmt::format("element vertex {}\nproperty double x\nproperty double y\nproperty double z\n", n);
  if (normals) header += "property double nx\nproperty double ny\nproperty double nz\n";
  if (colours) header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (deviation) header += "property double deviation_mm\n";
  if (parts.triangles.cols() > 0) {
    header += fmt::format("element face {}\nproperty list uchar uint vertex_indices\n", parts.triangles.cols());
  }
  header += "end_header\n";
  const std::size_t row = 24 + (normals ? 24U : 0U) + (colours ? 3U : 0U) + (deviation ? 8U : 0U);
  std::string bytes(
      header.size() + row * static_cast<std::size_t>(n) + 13 * static_cast<std::size_t>(parts.triangles.cols()), '\0');
  std::memcpy(bytes.data(), header.data(), header.size());
  char* at = bytes.data() + header.size();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < 3; ++k) at = put(at, parts.points(k, i));
    for (Eigen::Index k = 0; normals && k < 3; ++k) at = put(at, parts.normals(k, i));
    for (Eigen::Index k = 0; colours && k < 3; ++k) at = put(at, parts.colours(k, i));
    if (deviation) at = put(at, parts.deviation[static_cast<std::size_t>(i)]);
  }
  for (Eigen::Index i = 0; i < parts.triangles.cols(); ++i) {
    at = put(at, std::uint8_t{3});
    for (Eigen::Index k = 0; k < 3; ++k) at = put(at, parts.triangles(k, i));
  }
  return bytes;
}

}  // namespace abbe
