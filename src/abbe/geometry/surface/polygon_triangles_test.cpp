#include "abbe/geometry/surface/polygon_triangles.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace abbe {
namespace {

struct Cut {
  double area = 0;                                  // of the triangles, each counted positive
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();    // of their vector areas
  Eigen::Vector3d whole = Eigen::Vector3d::Zero();  // of the polygon
};

Cut cut(const Eigen::Matrix3Xd& vertices) {
  std::vector<std::uint32_t> corners(static_cast<std::size_t>(vertices.cols()));
  std::iota(corners.begin(), corners.end(), 0U);
  std::vector<std::uint32_t> triangles(3 * (corners.size() - 2));
  EXPECT_TRUE(polygon_triangles(vertices, corners, triangles.data()));
  Cut result;
  for (std::size_t i = 0; i < triangles.size(); i += 3) {
    const Eigen::Vector3d a = vertices.col(triangles[i]), b = vertices.col(triangles[i + 1]),
                          c = vertices.col(triangles[i + 2]);
    const Eigen::Vector3d area = 0.5 * (b - a).cross(c - a);
    result.area += area.norm();
    result.sum += area;
  }
  for (Eigen::Index i = 0; i < vertices.cols(); ++i) {
    const Eigen::Vector3d a = vertices.col(i), b = vertices.col((i + 1) % vertices.cols());
    result.whole += 0.5 * a.cross(b);
  }
  return result;
}

/// In a tilted plane away from the origin.
Eigen::Matrix3Xd tilted(const std::vector<Eigen::Vector2d>& outline) {
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  Eigen::Matrix3Xd vertices(3, static_cast<Eigen::Index>(outline.size()));
  for (std::size_t i = 0; i < outline.size(); ++i) {
    vertices.col(static_cast<Eigen::Index>(i)) =
        rotation * Eigen::Vector3d(outline[i].x(), outline[i].y(), 0) + Eigen::Vector3d(100, -50, 20);
  }
  return vertices;
}

void expect_covered_once(const std::vector<Eigen::Vector2d>& outline) {
  const Cut result = cut(tilted(outline));
  const double area = result.whole.norm();
  ASSERT_GT(area, 0);
  // Triangles outside the polygon or turned over would make the first of these larger than the second.
  EXPECT_NEAR(result.area, area, 1e-9 * area);
  EXPECT_NEAR((result.sum - result.whole).norm(), 0, 1e-9 * area);
}

TEST(PolygonTriangles, CoverConvexAndConcavePolygonsOnce) {
  expect_covered_once({{0, 0}, {4, 0}, {4, 3}, {0, 3}});
  expect_covered_once({{0, 0}, {4, 1}, {1, 1}, {1, 4}});  // an arrow, hollow at the third corner
  expect_covered_once({{1, 1}, {1, 4}, {0, 0}, {4, 1}});  // the same from its hollow corner
  expect_covered_once({{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 2}, {4, 2}, {4, 3}, {0, 3}});
  expect_covered_once({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 3}, {0, 3}});  // corners on a straight side
}

TEST(PolygonTriangles, CoverAStarOfManyPoints) {
  std::vector<Eigen::Vector2d> star;
  for (int i = 0; i < 200; ++i) {
    const double angle = 2 * std::numbers::pi * i / 200, radius = i % 2 == 0 ? 10 : 3 + 0.02 * i;
    star.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  expect_covered_once(star);
}

TEST(PolygonTriangles, ASpiralIsNotAFan) {
  std::vector<Eigen::Vector2d> spiral;
  for (int i = 0; i <= 100; ++i) {
    const double angle = 0.15 * i;
    spiral.emplace_back((1 + 0.3 * angle) * std::cos(angle), (1 + 0.3 * angle) * std::sin(angle));
  }
  for (int i = 100; i >= 0; --i) {
    const double angle = 0.15 * i;
    spiral.emplace_back((0.7 + 0.3 * angle) * std::cos(angle), (0.7 + 0.3 * angle) * std::sin(angle));
  }
  expect_covered_once(spiral);
}

TEST(PolygonTriangles, PolygonsWithoutAreaOrThatCrossThemselvesBecomeAFan) {
  for (const std::vector<Eigen::Vector2d>& outline :
       {std::vector<Eigen::Vector2d>{{0, 0}, {1, 0}, {2, 0}, {3, 0}},
        std::vector<Eigen::Vector2d>{{0, 0}, {2, 2}, {2, 0}, {0, 2}},
        std::vector<Eigen::Vector2d>{{1, 1}, {1, 1}, {1, 1}, {1, 1}, {1, 1}}}) {
    EXPECT_TRUE(std::isfinite(cut(tilted(outline)).area));
  }
}

TEST(PolygonTriangles, LargeConcavePolygonsAreRefusedAndLargeConvexOnesAreNot) {
  const std::size_t n = kLargestConcavePolygon + 2;
  Eigen::Matrix3Xd ring(3, static_cast<Eigen::Index>(n));
  std::vector<std::uint32_t> corners(n), triangles(3 * n);
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    ring.col(static_cast<Eigen::Index>(i)) << std::cos(angle), std::sin(angle), 5;
    corners[i] = static_cast<std::uint32_t>(i);
  }
  EXPECT_TRUE(polygon_triangles(ring, corners, triangles.data()));
  ring.col(3) *= 0.5;
  EXPECT_FALSE(polygon_triangles(ring, corners, triangles.data()));
}

}  // namespace
}  // namespace abbe
