#include "abbe/formats/shapes/face_triangles.h"

#include <cassert>

#include "abbe/geometry/surface/polygon_triangles.h"

namespace abbe {

void FaceTriangles::add(std::span<const std::uint32_t> corners, std::size_t offset) {
  assert(corners.size() >= 3);
  if (corners.size() == 3) {
    triangles_.insert(triangles_.end(), corners.begin(), corners.end());
    return;
  }
  polygons_.push_back({size(), corners_.size(), corners.size(), offset});
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  triangles_.resize(triangles_.size() + 3 * (corners.size() - 2));
}

void FaceTriangles::append(const FaceTriangles& other) {
  const std::size_t triangle = size(), corner = corners_.size();
  for (Polygon polygon : other.polygons_) {
    polygon.triangle += triangle;
    polygon.corner += corner;
    polygons_.push_back(polygon);
  }
  triangles_.insert(triangles_.end(), other.triangles_.begin(), other.triangles_.end());
  corners_.insert(corners_.end(), other.corners_.begin(), other.corners_.end());
}

std::optional<std::size_t> FaceTriangles::cut(const Eigen::Matrix3Xd& vertices) {
  for (const Polygon& polygon : polygons_) {
    const std::span<const std::uint32_t> corners(corners_.data() + polygon.corner, polygon.count);
    if (!polygon_triangles(vertices, corners, triangles_.data() + 3 * polygon.triangle)) return polygon.offset;
  }
  return std::nullopt;
}

}  // namespace abbe
