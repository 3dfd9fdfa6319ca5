#include "abbe/geometry/surface/smooth_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "abbe/geometry/parts_for_test.h"

namespace abbe {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// z = -(x, y) S (x, y)^T / 2 about the origin, normals upwards, so that S is how the normal turns with the place.
TriangleMesh dome(const Matrix2d& shape) {
  constexpr std::size_t kSide = 11;
  constexpr double kStep = 0.01;
  std::vector<Vector3d> vertices;
  std::vector<std::array<std::size_t, 3>> triangles;
  for (std::size_t i = 0; i < kSide; ++i) {
    for (std::size_t j = 0; j < kSide; ++j) {
      const Vector2d at = kStep * Vector2d(static_cast<double>(i) - 5, static_cast<double>(j) - 5);
      vertices.emplace_back(at.x(), at.y(), -0.5 * at.dot(shape * at));
      if (i + 1 == kSide || j + 1 == kSide) continue;
      const std::size_t a = i * kSide + j, b = a + kSide;
      triangles.push_back({a, b, b + 1});
      triangles.push_back({a, b + 1, a + 1});
    }
  }
  return parts::mesh_of(vertices, triangles);
}
constexpr std::uint32_t kMiddle = 2 * (5 * 10 + 5);

TEST(SmoothSurface, HasThePrincipalCurvaturesOfTheSurfaceThatItStandsFor) {
  // Convex, saddle, cylinder along each axis and askew, hollow; the axes in every order.
  for (const auto& [xx, xy, yy] :
       {std::array{0.3, 0.0, 0.1}, std::array{0.1, 0.0, 0.3}, std::array{0.2, 0.15, -0.1}, std::array{-0.1, -0.15, 0.2},
        std::array{0.0, 0.0, 0.2}, std::array{0.2, 0.0, 0.0}, std::array{0.1, 0.1, 0.1}, std::array{0.1, -0.1, 0.1},
        std::array{-0.3, 0.02, -0.4}}) {
    Matrix2d shape;
    shape << xx, xy, xy, yy;
    const SmoothSurface::Curvature found = SmoothSurface(dome(shape)).curvature(kMiddle);
    const Eigen::SelfAdjointEigenSolver<Matrix2d> expected(shape);
    for (int k = 0; k < 2; ++k) {
      EXPECT_NEAR(found.value[k], expected.eigenvalues()[k], 1e-3) << shape;
      EXPECT_NEAR(found.direction[k].norm(), 1, 1e-14);
      const Vector2d along = expected.eigenvectors().col(k);
      EXPECT_NEAR(std::abs(found.direction[k].head<2>().dot(along)), 1, 1e-4) << shape;
    }
    EXPECT_NEAR(found.direction[0].dot(found.direction[1]), 0, 1e-14);
  }
}

TEST(SmoothSurface, OfASphereIsCurvedAlikeInAllDirections) {
  const TriangleMesh ball = parts::sphere(20, 180, 90);
  const SmoothSurface surface(ball);
  for (const std::uint32_t triangle : {3000u, 8000u, 16000u, 21111u}) {
    const SmoothSurface::Curvature found = surface.curvature(triangle);
    EXPECT_NEAR(found.value[0], 0.05, 5e-4);
    EXPECT_NEAR(found.value[1], 0.05, 5e-4);
    EXPECT_NEAR(found.direction[0].dot(found.direction[1]), 0, 1e-14);
  }
}

TEST(SmoothSurface, ThatIsPlaneHasDirectionsNevertheless) {
  const SmoothSurface::Curvature found = SmoothSurface(dome(Matrix2d::Zero())).curvature(kMiddle);
  EXPECT_EQ(found.value[0], 0);
  EXPECT_EQ(found.value[1], 0);
  EXPECT_NEAR(found.direction[0].cross(found.direction[1]).norm(), 1, 1e-14);
}

TEST(SmoothSurface, OfATriangleWithoutAreaHasNoCurvature) {
  const TriangleMesh needle = parts::mesh_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
  const SmoothSurface::Curvature found = SmoothSurface(needle).curvature(0);
  EXPECT_EQ(found.direction[0], Vector3d::Zero());
  EXPECT_EQ(found.value[1], 0);
}

}  // namespace
}  // namespace abbe
