#include "abbe/plan/scans/wanted_area.h"

#include <Eigen/Geometry>

namespace abbe {
namespace {

using Polygon = std::vector<Eigen::Vector3d>;

/// What of a convex polygon lies in a half-space.
/// Source: I. Sutherland, G. Hodgman, Reentrant polygon clipping. Communications of the ACM 17 (1974) 32.
Polygon cut(const Polygon& polygon, const HalfSpace& half) {
  Polygon inside;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const double a = half.normal.dot(from) - half.offset, b = half.normal.dot(to) - half.offset;
    if (a >= 0) inside.push_back(from);
    if ((a >= 0) != (b >= 0)) inside.push_back(from + a / (a - b) * (to - from));
  }
  return inside;
}

}  // namespace

double wanted_area(const TriangleMesh& mesh, const std::vector<HalfSpace>& wanted) {
  double area = 0;
  for (Eigen::Index i = 0; i < mesh.size(); ++i) {
    Polygon polygon{mesh.corner(i, 0), mesh.corner(i, 1), mesh.corner(i, 2)};
    for (const HalfSpace& half : wanted) polygon = cut(polygon, half);
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      area += 0.5 * (polygon[k - 1] - polygon[0]).cross(polygon[k] - polygon[0]).norm();
    }
  }
  return area;
}

}  // namespace abbe
