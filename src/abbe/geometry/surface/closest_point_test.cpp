#include "abbe/geometry/surface/closest_point.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/geometry/fits/numbers_for_test.h"
#include "abbe/geometry/parts_for_test.h"
#include "abbe/geometry/rotation.h"

namespace abbe {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::Numbers;

#if defined(__SIZEOF_FLOAT128__)
__extension__ using Quad = __float128;
#else
using Quad = long double;
#endif

template <class Number>
struct Vector3 {
  Number x, y, z;
  explicit Vector3(const Vector3d& v) : x(v.x()), y(v.y()), z(v.z()) {}
  Vector3(Number a, Number b, Number c) : x(a), y(b), z(c) {}
  Vector3 operator-(const Vector3& o) const { return {x - o.x, y - o.y, z - o.z}; }
  Vector3 operator*(Number s) const { return {x * s, y * s, z * s}; }
  Number dot(const Vector3& o) const { return x * o.x + y * o.y + z * o.z; }
  Vector3 cross(const Vector3& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
};

/// By the least of the distances to the plane, if the foot is inside, and to the sides, in a precision in which nothing
/// has to be arranged for needles.
template <class Number>
double distance_to_triangle(const Vector3d& point, const TriangleMesh& mesh, Eigen::Index triangle) {
  const Vector3<Number> p(point), a(mesh.corner(triangle, 0)), b(mesh.corner(triangle, 1)), c(mesh.corner(triangle, 2));
  const auto to_segment = [&](const Vector3<Number>& u, const Vector3<Number>& v) {
    const Vector3<Number> e = v - u, from = p - u;
    const Number square = e.dot(e);
    Number t = square > 0 ? from.dot(e) / square : Number(0);
    t = t < 0 ? Number(0) : (t > 1 ? Number(1) : t);
    const Vector3<Number> rest = from - e * t;
    return rest.dot(rest);
  };
  Number nearest = std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
  const Vector3<Number> n = (b - a).cross(c - a);
  if (n.dot(n) > 0 && n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0 &&
      n.dot((a - c).cross(p - c)) >= 0) {
    const Number height = n.dot(p - a);
    nearest = std::min(nearest, height * height / n.dot(n));
  }
  return static_cast<double>(std::sqrt(static_cast<long double>(nearest)));
}

/// Quick for all triangles, precise for those that may be nearest.
double distance_by_trying_all(const TriangleMesh& mesh, const Vector3d& point) {
  std::vector<double> quick;
  for (Eigen::Index t = 0; t < mesh.size(); ++t) quick.push_back(distance_to_triangle<double>(point, mesh, t));
  const double limit = *std::min_element(quick.begin(), quick.end()) * (1 + 1e-5) + 1e-3;
  double nearest = std::numeric_limits<double>::infinity();
  for (Eigen::Index t = 0; t < mesh.size(); ++t) {
    if (quick[static_cast<std::size_t>(t)] > limit) continue;
    nearest = std::min(nearest, distance_to_triangle<Quad>(point, mesh, t));
  }
  return nearest;
}

/// Triangles anywhere: a third of them small, some needles of all degrees, some without area.
TriangleMesh soup(Eigen::Index triangles, std::uint64_t seed) {
  Numbers numbers(seed);
  TriangleMesh mesh;
  mesh.vertices.resize(3, 3 * triangles);
  mesh.triangles.resize(3, triangles);
  for (Eigen::Index t = 0; t < triangles; ++t) {
    const Vector3d a(numbers.uniform(-50, 50), numbers.uniform(-50, 50), numbers.uniform(-50, 50));
    const double size = t % 3 == 0 ? 20 : 0.5;
    const Vector3d u = size * numbers.normal3(), v = size * numbers.normal3();
    mesh.vertices.col(3 * t) = a;
    mesh.vertices.col(3 * t + 1) = a + u;
    mesh.vertices.col(3 * t + 2) = t % 7 == 0   ? Vector3d(a + 0.4 * u + 1e-9 * v)
                                   : t % 7 == 1 ? Vector3d(a + 2 * u)
                                   : t % 7 == 2 ? a
                                   : t % 7 == 3 ? Vector3d(a + 0.4 * u + std::pow(10, numbers.uniform(-6, 0)) * v)
                                                : Vector3d(a + v);
    for (int k = 0; k < 3; ++k) mesh.triangles(k, t) = static_cast<std::uint32_t>(3 * t + k);
  }
  return mesh;
}

/// Points near, far, on vertices, on edges and on faces.
Matrix3Xd points_around(const TriangleMesh& mesh, Eigen::Index count, std::uint64_t seed) {
  Numbers numbers(seed);
  Matrix3Xd points(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index t = static_cast<Eigen::Index>(numbers.below(static_cast<std::size_t>(mesh.size())));
    const Vector3d a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
    const double u = numbers.uniform(), v = numbers.uniform(0, 1 - u);
    switch (i % 6) {
      case 0:
        points.col(i) = a;
        break;
      case 1:
        points.col(i) = a + u * (b - a);
        break;
      case 2:
        points.col(i) = a + u * (b - a) + v * (c - a);
        break;
      case 3:
        points.col(i) = a + u * (b - a) + v * (c - a) + 0.1 * numbers.normal3();
        break;
      case 4:
        points.col(i) = a + 30 * numbers.normal3();
        break;
      default:
        points.col(i) = 1e4 * numbers.normal3();
        break;
    }
  }
  return points;
}

TEST(ClosestPoint, IsExactOnTrianglesOfAllShapesAgainstTryingAll) {
  for (const Eigen::Index triangles : {1, 7, 9, 65, 700}) {
    const TriangleMesh mesh = soup(triangles, static_cast<std::uint64_t>(triangles));
    const Matrix3Xd points = points_around(mesh, 600, 5);
    const std::vector<SurfacePoint> found = ClosestPointFinder(mesh).closest(points);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const Vector3d p = points.col(i);
      const SurfacePoint& at = found[static_cast<std::size_t>(i)];
      const double expected = distance_by_trying_all(mesh, p), size = std::max(100.0, p.norm());
      ASSERT_NEAR(std::abs(at.distance), expected, 1e-14 * size) << triangles << " " << i;
      ASSERT_NEAR((p - at.point).norm(), expected, 1e-14 * size);
      ASSERT_NEAR(distance_to_triangle<Quad>(p, mesh, at.triangle), expected, 1e-14 * size);
    }
  }
}

TEST(ClosestPoint, IsAsExactFarFromTheOrigin) {
  TriangleMesh mesh = soup(300, 3);
  const Vector3d away(1e6, -2e6, 3e5);
  // Rounded where it stands, so that the mesh is exactly the moved one.
  mesh.vertices.colwise() += away;
  Matrix3Xd points = points_around(mesh, 300, 4);
  for (Eigen::Index i = 5; i < points.cols(); i += 6) points.col(i) += away;
  const Eigen::VectorXd found = ClosestPointFinder(mesh).signed_distances(points);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const double expected = distance_by_trying_all(mesh, points.col(i));
    ASSERT_NEAR(std::abs(found[i]), expected, 1e-14 * std::max(100.0, (points.col(i) - away).norm())) << i;
  }
}

TEST(ClosestPoint, DoesNotDependOnThreadsNeighboursOrOrder) {
  const TriangleMesh mesh = parts::blade(60, 80);
  const Matrix3Xd points = points_around(mesh, 9000, 8);
  const ClosestPointFinder one(mesh, 1), three(mesh, 3);
  const std::vector<SurfacePoint> a = one.closest(points, 1), b = three.closest(points, 3);
  const Eigen::VectorXd c = three.signed_distances(points.rowwise().reverse(), 2);
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].distance, b[i].distance) << i;
    ASSERT_EQ(a[i].triangle, b[i].triangle) << i;
    ASSERT_EQ(a[i].point, b[i].point) << i;
    ASSERT_EQ(a[i].distance, c[static_cast<Eigen::Index>(a.size() - 1 - i)]) << i;
  }
  // Hints of another place are of no use, but do no harm.
  std::vector<std::uint32_t> hints(a.size(), ClosestPointFinder::kNoHint);
  std::vector<SurfacePoint> d(a.size());
  one.closest_block(points.rowwise().reverse(), d.data(), hints.data());
  one.closest_block(points, d.data(), hints.data());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i].point, d[i].point) << i;
}

/// Inside of the stepped box, by its three boxes.
bool inside_stepped_box(const Vector3d& p) {
  if (p.z() < 0 || p.z() > 24 || p.x() < 0 || p.y() < 0) return false;
  return (p.x() <= 20 && p.y() <= 30) || (p.x() <= 38 && p.y() <= 17) || (p.x() <= 50 && p.y() <= 6);
}

TEST(ClosestPoint, HasTheRightSignEverywhereAroundEdgesAndCorners) {
  Numbers numbers(12);
  for (const int subdivisions : {0, 1, 3}) {
    // Subdivided meshes do not share their vertices: places count, not numbers.
    const ClosestPointFinder finder(parts::stepped_box(subdivisions));
    for (int i = 0; i < 6000; ++i) {
      Vector3d p(numbers.uniform(-10, 60), numbers.uniform(-10, 40), numbers.uniform(-10, 34));
      const std::array<double, 5> xs{0, 20, 38, 50, 25}, ys{0, 6, 17, 30, 10};
      // Half of the points close to the planes of the faces, where edges and corners are nearest.
      if (i % 2 == 0) p.x() = xs[numbers.below(5)] + 1e-3 * numbers.normal();
      if (i % 4 < 2) p.y() = ys[numbers.below(5)] + 1e-3 * numbers.normal();
      const SurfacePoint at = finder.closest_to(p);
      ASSERT_EQ(at.distance < 0, inside_stepped_box(p)) << p.transpose() << " " << at.distance;
      ASSERT_FALSE(at.on_border);
    }
  }
}

TEST(ClosestPoint, SignIsTheSameOnBothSidesOfATriangleWithoutAreaBetweenTwoFaces) {
  // A roof whose ridge is divided on one side only; the gap is filled with a triangle without area.
  const TriangleMesh mesh =
      parts::mesh_of({{0, -1, 0}, {2, -1, 0}, {0, 0, 1}, {2, 0, 1}, {1, 0, 1}, {0, 1, 0}, {2, 1, 0}},
                     {{0, 1, 3}, {0, 3, 2}, {2, 3, 4}, {2, 4, 5}, {4, 6, 5}, {4, 3, 6}});
  const ClosestPointFinder finder(mesh);
  for (const double x : {0.3, 1.0, 1.7}) {
    EXPECT_NEAR(finder.closest_to(Vector3d(x, 0, 1.5)).distance, 0.5, 1e-15);
    EXPECT_NEAR(finder.closest_to(Vector3d(x, 0.2, 1.5)).distance, std::hypot(0.2, 0.5), 1e-15);
    EXPECT_NEAR(finder.closest_to(Vector3d(x, -0.2, 1.5)).distance, std::hypot(0.2, 0.5), 1e-15);
    EXPECT_LT(finder.closest_to(Vector3d(x, 0.05, 0.5)).distance, 0);
    EXPECT_LT(finder.closest_to(Vector3d(x, -0.05, 0.5)).distance, 0);
  }
}

TEST(ClosestPoint, OfASphereLiesOnTheLineToTheCentre) {
  const Vector3d centre(3, -2, 7);
  const ClosestPointFinder finder(parts::sphere(10, 400, 200, centre));
  Numbers numbers(6);
  for (int i = 0; i < 500; ++i) {
    const Vector3d direction = numbers.normal3().normalized();
    const double radius = numbers.uniform(5, 15);
    const SurfacePoint at = finder.closest_to(centre + radius * direction);
    // The chords of 0.9 degrees lie up to 10 mm * (1 - cos(0.45 deg))^2-ish below the sphere.
    EXPECT_NEAR(at.distance, radius - 10, 1.3e-3);
    EXPECT_GT(at.distance, radius - 10 - 1e-12);
    EXPECT_GT(at.normal.dot(direction), std::cos(0.03));
  }
}

TEST(ClosestPoint, OpenMeshGivesTheSideOfTheSheetAndItsBorder) {
  const TriangleMesh sheet = parts::mesh_of({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {{0, 1, 2}, {0, 2, 3}});
  const ClosestPointFinder finder(sheet);
  EXPECT_EQ(finder.closest_to(Vector3d(1, 2, 3)).distance, 3);
  EXPECT_EQ(finder.closest_to(Vector3d(1, 2, -3)).distance, -3);
  EXPECT_FALSE(finder.closest_to(Vector3d(2, 2, 1)).on_border) << "the diagonal is inside";
  const SurfacePoint beyond = finder.closest_to(Vector3d(7, 2, -4));
  EXPECT_EQ(beyond.distance, -5);
  EXPECT_TRUE(beyond.on_border);
  EXPECT_EQ(beyond.feature, SurfaceFeature::edge);
  const SurfacePoint corner = finder.closest_to(Vector3d(-1, -2, 2));
  EXPECT_EQ(corner.distance, 3);
  EXPECT_TRUE(corner.on_border);
  EXPECT_EQ(corner.feature, SurfaceFeature::vertex);
}

TEST(ClosestPoint, ManyPointsStopWhenAsked) {
  const TriangleMesh mesh = parts::stepped_box();
  const ClosestPointFinder finder(mesh);
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(finder.closest(points_around(mesh, 9000, 1), 0, source.get_token()), Stopped);
}

TEST(ClosestPoint, HugeCoordinatesStopNothing) {
  const ClosestPointFinder finder(parts::stepped_box());
  const SurfacePoint at = finder.closest_to(Vector3d(1e30, 0, 0));
  EXPECT_EQ(at.distance, 1e30);
  EXPECT_NEAR(finder.closest_to(Vector3d(1e9, 3, 12)).distance, 1e9 - 50, 1e-6);
}

}  // namespace
}  // namespace abbe
