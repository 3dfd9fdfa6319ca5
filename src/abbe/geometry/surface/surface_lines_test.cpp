#include "abbe/geometry/surface/surface_lines.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "abbe/geometry/surface/meshes_for_test.h"

namespace abbe {
namespace {

using std::numbers::pi;

TEST(SurfaceLines, AreCirclesOfACylinderEvenlySpaced) {
  const TriangleMesh mesh = prism_for_test(360, 8, -6, 6);
  std::vector<std::uint32_t> side;
  for (std::uint32_t i = 0; i < 360; ++i) {
    side.push_back(4 * i);
    side.push_back(4 * i + 1);
  }
  const SmoothSurface smooth(mesh, 0.3);
  const std::vector<SurfaceLine> lines = surface_lines(mesh, smooth, side, Eigen::Vector3d::UnitY(), 0.5, 1.5);
  ASSERT_EQ(lines.size(), 8U);
  for (const SurfaceLine& line : lines) {
    EXPECT_TRUE(line.is_closed);
    ASSERT_EQ(line.points.cols(), 101);  // 2 pi 8 / 0.5, rounded up
    for (Eigen::Index k = 0; k < line.points.cols(); ++k) {
      const Eigen::Vector3d p = line.points.col(k), next = line.points.col((k + 1) % line.points.cols());
      EXPECT_NEAR(p.y(), line.height, 1e-12);
      EXPECT_NEAR(std::hypot(p.x(), p.z()), 8, 4e-4);
      EXPECT_NEAR((next - p).norm(), 2 * pi * 8 / 101, 1e-3);
      EXPECT_NEAR(line.normals.col(k).dot(p) / std::hypot(p.x(), p.z()), 1, 1e-4);
    }
  }
}

}  // namespace
}  // namespace abbe
