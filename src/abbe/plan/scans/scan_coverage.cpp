#include "abbe/plan/scans/scan_coverage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace abbe {
namespace {

using Cell = std::array<long, 3>;

Cell cell_of(const Eigen::Vector3d& point, double size) {
  return {std::lround(std::floor(point.x() / size)), std::lround(std::floor(point.y() / size)),
          std::lround(std::floor(point.z() / size))};
}

}  // namespace

std::vector<CoveredPlace> covered_places(const TriangleMesh& mesh, const std::vector<std::uint32_t>& face_of_triangle,
                                         const std::vector<ScannedPlace>& scanned,
                                         const std::vector<std::uint32_t>& triangles,
                                         const std::function<bool(const Eigen::Vector3d&)>& wanted, double radius) {
  std::map<Cell, std::vector<ScannedPlace>> cells;
  for (const ScannedPlace& place : scanned) cells[cell_of(place.point, radius)].push_back(place);
  const auto obstacle_at = [&](const Eigen::Vector3d& point, std::uint32_t face) {
    const Cell cell = cell_of(point, radius);
    ScanObstacle nearest = ScanObstacle::spacing;
    double least = 4 * radius * radius;
    for (long i = -2; i <= 2; ++i) {
      for (long j = -2; j <= 2; ++j) {
        // The cells of a row follow each other.
        const Cell last{cell[0] + i, cell[1] + j, cell[2] + 2};
        auto found = cells.lower_bound({cell[0] + i, cell[1] + j, cell[2] - 2});
        for (; found != cells.end() && found->first <= last; ++found) {
          for (const ScannedPlace& other : found->second) {
            if (other.face != face) continue;
            const double square = (other.point - point).squaredNorm();
            if (other.obstacle == ScanObstacle::none) {
              if (square <= radius * radius) return ScanObstacle::none;
            } else if (square < least) {
              least = square;
              nearest = other.obstacle;
            }
          }
        }
      }
    }
    return nearest;
  };
  std::vector<CoveredPlace> places;
  struct Triangle {
    Eigen::Vector3d a, b, c;
  };
  std::vector<Triangle> waiting;
  for (const std::uint32_t i : triangles) {
    waiting.push_back({mesh.corner(i, 0), mesh.corner(i, 1), mesh.corner(i, 2)});
    while (!waiting.empty()) {
      const Triangle t = waiting.back();
      waiting.pop_back();
      const double ab = (t.b - t.a).norm(), bc = (t.c - t.b).norm(), ca = (t.a - t.c).norm();
      const double longest = std::max({ab, bc, ca});
      if (longest > 0.5 * radius) {
        // Halved across the longest side, so that needles do not become thousands of pieces.
        if (longest == ab) {
          const Eigen::Vector3d middle = 0.5 * (t.a + t.b);
          waiting.push_back({t.a, middle, t.c});
          waiting.push_back({middle, t.b, t.c});
        } else if (longest == bc) {
          const Eigen::Vector3d middle = 0.5 * (t.b + t.c);
          waiting.push_back({t.a, t.b, middle});
          waiting.push_back({t.a, middle, t.c});
        } else {
          const Eigen::Vector3d middle = 0.5 * (t.a + t.c);
          waiting.push_back({t.a, t.b, middle});
          waiting.push_back({middle, t.b, t.c});
        }
        continue;
      }
      const Eigen::Vector3d point = (t.a + t.b + t.c) / 3;
      if (!wanted(point)) continue;
      places.push_back({point, i, 0.5 * (t.b - t.a).cross(t.c - t.a).norm(), obstacle_at(point, face_of_triangle[i])});
    }
  }
  return places;
}

}  // namespace abbe
