#include "abbe/geometry/surface/polygon_triangles.h"

#include <Eigen/Geometry>
#include <cassert>
#include <vector>

namespace abbe {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Twice the area of a triangle, positive anticlockwise.
double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return cross(b - a, c - a);
}

void fan(std::span<const std::uint32_t> corners, std::uint32_t* triangles) {
  for (std::size_t i = 2; i < corners.size(); ++i) {
    *triangles++ = corners[0];
    *triangles++ = corners[i - 1];
    *triangles++ = corners[i];
  }
}

/// Corners in the plane of the mean normal, anticlockwise; empty without area.
std::vector<Eigen::Vector2d> in_plane(const Eigen::Matrix3Xd& vertices, std::span<const std::uint32_t> corners) {
  const Eigen::Vector3d first = vertices.col(corners[0]);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t i = 2; i < corners.size(); ++i) {
    normal += (vertices.col(corners[i - 1]) - first).cross(vertices.col(corners[i]) - first);
  }
  const double length = normal.norm();
  if (!(length > 0)) return {};
  normal /= length;
  const Eigen::Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<Eigen::Vector2d> points;
  points.reserve(corners.size());
  for (const std::uint32_t corner : corners) {
    const Eigen::Vector3d offset = vertices.col(corner) - first;
    points.emplace_back(offset.dot(u), offset.dot(v));
  }
  return points;
}

/// True if the fan from the first corner has no triangle that turns the other way, and goes around once.
bool fan_is_inside(const std::vector<Eigen::Vector2d>& points) {
  const std::size_t n = points.size();
  int changes = 0;
  bool was_up = false;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d &a = points[i], &b = points[(i + 1) % n], &c = points[(i + 2) % n];
    // Corners on a straight side may lie a rounding inside it.
    if (turn(a, b, c) < -1e-9 * (b - a).norm() * (c - b).norm()) return false;
    const bool up = b.y() > a.y() || (b.y() == a.y() && b.x() > a.x());
    if (i > 0 && up != was_up) ++changes;
    was_up = up;
  }
  return changes <= 2;
}

class Ears {
 public:
  Ears(const std::vector<Eigen::Vector2d>& points, std::span<const std::uint32_t> corners)
      : points_(points), corners_(corners) {
    for (std::size_t i = 0; i < points.size(); ++i) left_.push_back(i);
  }

  /// @returns false if none is left although the polygon is not used up: it crosses itself
  bool cut(std::uint32_t* triangles) {
    std::size_t at = 0, tried = 0;
    while (left_.size() > 3) {
      if (tried == left_.size()) return false;
      if (!is_ear(at)) {
        at = (at + 1) % left_.size();
        ++tried;
        continue;
      }
      triangles = write(triangles, at);
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>((at + 1) % left_.size()));
      at %= left_.size();
      tried = 0;
    }
    write(triangles, 0);
    return true;
  }

 private:
  std::size_t corner(std::size_t at) const { return left_[at % left_.size()]; }

  std::uint32_t* write(std::uint32_t* triangles, std::size_t at) const {
    for (std::size_t k = 0; k < 3; ++k) *triangles++ = corners_[corner(at + k)];
    return triangles;
  }

  bool is_ear(std::size_t at) const {
    const Eigen::Vector2d &a = points_[corner(at)], &b = points_[corner(at + 1)], &c = points_[corner(at + 2)];
    if (!(turn(a, b, c) > 0)) return false;
    for (std::size_t i = at + 3; i < at + left_.size(); ++i) {
      const Eigen::Vector2d& p = points_[corner(i)];
      if (p == a || p == b || p == c) continue;
      if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
  }

  const std::vector<Eigen::Vector2d>& points_;
  std::span<const std::uint32_t> corners_;
  std::vector<std::size_t> left_;
};

}  // namespace

bool polygon_triangles(const Eigen::Matrix3Xd& vertices, std::span<const std::uint32_t> corners,
                       std::uint32_t* triangles) {
  assert(corners.size() >= 3);
  if (corners.size() == 3) {
    fan(corners, triangles);
    return true;
  }
  const std::vector<Eigen::Vector2d> points = in_plane(vertices, corners);
  if (!points.empty() && !fan_is_inside(points)) {
    if (corners.size() > kLargestConcavePolygon) return false;
    if (Ears(points, corners).cut(triangles)) return true;
  }
  fan(corners, triangles);
  return true;
}

}  // namespace abbe
