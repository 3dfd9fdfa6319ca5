#include "abbe/geometry/surface/ray_tracer.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <random>

namespace abbe {
namespace {

/// Every triangle by Cramer's rule.
double first_by_brute_force(const TriangleMesh& mesh, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                            double from, double to) {
  double nearest = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < mesh.size(); ++i) {
    Eigen::Matrix3d m;
    m << mesh.corner(i, 1) - mesh.corner(i, 0), mesh.corner(i, 2) - mesh.corner(i, 0), -direction;
    if (std::abs(m.determinant()) < 1e-14) continue;
    const Eigen::Vector3d s = m.inverse() * (origin - mesh.corner(i, 0));
    if (s[0] < 0 || s[1] < 0 || s[0] + s[1] > 1 || s[2] < from || s[2] > to) continue;
    nearest = std::min(nearest, s[2]);
  }
  return nearest;
}

TEST(RayTracer, FindsTheFirstTriangleAsBruteForceDoes) {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  TriangleMesh mesh;
  constexpr int kTriangles = 700;
  mesh.vertices.resize(3, 3 * kTriangles);
  mesh.triangles.resize(3, kTriangles);
  for (int i = 0; i < kTriangles; ++i) {
    const Eigen::Vector3d at(1e3 + 5 * normal(generator), 5 * normal(generator), 5 * normal(generator));
    for (int k = 0; k < 3; ++k) {
      mesh.vertices.col(3 * i + k) = at + Eigen::Vector3d(normal(generator), normal(generator), normal(generator));
      mesh.triangles(k, i) = static_cast<std::uint32_t>(3 * i + k);
    }
  }
  const RayTracer tracer(mesh);
  int hits = 0;
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector3d origin(1e3 + 8 * normal(generator), 8 * normal(generator), 8 * normal(generator));
    Eigen::Vector3d direction(normal(generator), normal(generator), normal(generator));
    if (k % 10 == 0) direction = Eigen::Vector3d::Unit(k / 10 % 3) * (k % 20 == 0 ? 1 : -1);
    direction.normalize();
    const double from = k % 3 == 0 ? -4 : 0.0, to = k % 5 == 0 ? 6 : 100;
    const double expected = first_by_brute_force(mesh, origin, direction, from, to);
    const std::optional<RayHit> hit = tracer.first(origin, direction, from, to);
    ASSERT_EQ(hit.has_value(), std::isfinite(expected)) << k;
    if (!hit) continue;
    ++hits;
    ASSERT_NEAR(hit->distance, expected, 1e-9) << k;
    const auto triangle = static_cast<Eigen::Index>(hit->triangle);
    ASSERT_NEAR(hit->normal.dot(origin + hit->distance * direction - mesh.corner(triangle, 0)), 0, 1e-9);
  }
  EXPECT_GT(hits, 500);
}

TEST(RayTracer, LetsNoRayThroughTheEdgesOfAClosedSurface) {
  // A fan about a vertex: rays exactly through vertices and through the middles of edges.
  TriangleMesh mesh;
  constexpr int kSides = 17;
  mesh.vertices.resize(3, kSides + 2);
  mesh.triangles.resize(3, 2 * kSides);
  for (int i = 0; i < kSides; ++i) {
    const double angle = 0.1 + 2 * 3.14159265358979 * i / kSides;
    mesh.vertices.col(i) = Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.1 * std::sin(3 * angle));
    const auto a = static_cast<std::uint32_t>(i), b = static_cast<std::uint32_t>((i + 1) % kSides);
    mesh.triangles.col(2 * i) << a, b, kSides;
    mesh.triangles.col(2 * i + 1) << b, a, kSides + 1;
  }
  mesh.vertices.col(kSides) << 0.03, 0.01, 1.1;
  mesh.vertices.col(kSides + 1) << 0.02, -0.05, -1.3;
  const RayTracer tracer(mesh);
  const Eigen::Vector3d middle(0.01, 0.02, 0);
  for (Eigen::Index i = 0; i < mesh.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d corner = mesh.corner(i, k), half = 0.5 * (corner + mesh.corner(i, (k + 1) % 3));
      for (const Eigen::Vector3d& target : {corner, half}) {
        const Eigen::Vector3d direction = (target - middle).normalized();
        EXPECT_TRUE(tracer.first(middle, direction, 0, 10)) << i << " " << k;
        const std::optional<RayHit> back = tracer.first(middle + 5 * direction, -direction, 0, 5);
        EXPECT_TRUE(back) << i << " " << k;
      }
    }
  }
}

}  // namespace
}  // namespace abbe
