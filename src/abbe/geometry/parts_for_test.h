#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "abbe/geometry/fits/numbers_for_test.h"
#include "abbe/geometry/surface/triangle_mesh.h"

/// Parts made in code, closed and oriented outwards unless said otherwise.
namespace abbe::parts {

inline TriangleMesh mesh_of(const std::vector<Eigen::Vector3d>& vertices,
                            const std::vector<std::array<std::size_t, 3>>& triangles) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t i = 0; i < vertices.size(); ++i) mesh.vertices.col(static_cast<Eigen::Index>(i)) = vertices[i];
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.triangles(static_cast<int>(k), static_cast<Eigen::Index>(i)) = static_cast<std::uint32_t>(triangles[i][k]);
    }
  }
  return mesh;
}

/// A tube of closed rings with a fan over each end: rings[i][k], anticlockwise seen from the last ring.
inline TriangleMesh tube(const std::vector<std::vector<Eigen::Vector3d>>& rings) {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::size_t, 3>> triangles;
  const std::size_t around = rings[0].size(), last = (rings.size() - 1) * around;
  for (const auto& ring : rings) vertices.insert(vertices.end(), ring.begin(), ring.end());
  for (std::size_t i = 0; i + 1 < rings.size(); ++i) {
    for (std::size_t k = 0; k < around; ++k) {
      const std::size_t a = i * around + k, b = i * around + (k + 1) % around;
      triangles.push_back({a, b, b + around});
      triangles.push_back({a, b + around, a + around});
    }
  }
  for (const bool top : {false, true}) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : rings[top ? rings.size() - 1 : 0]) middle += p / static_cast<double>(around);
    const std::size_t centre = vertices.size(), base = top ? last : 0;
    vertices.push_back(middle);
    for (std::size_t k = 0; k < around; ++k) {
      const std::size_t a = base + k, b = base + (k + 1) % around;
      triangles.push_back(top ? std::array{a, b, centre} : std::array{b, a, centre});
    }
  }
  return mesh_of(vertices, triangles);
}

/// Along z from 0 to the height; flats cut at these distances from the axis, each at its angle.
inline TriangleMesh cylinder_with_flats(double radius, double height, std::size_t around, std::size_t along,
                                        const std::vector<std::pair<double, double>>& flats) {
  std::vector<std::vector<Eigen::Vector3d>> rings(along + 1);
  for (std::size_t i = 0; i <= along; ++i) {
    for (std::size_t k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(around);
      double r = radius;
      for (const auto& [distance, at] : flats) {
        const double towards = std::cos(angle - at);
        if (towards > 0) r = std::min(r, distance / towards);
      }
      rings[i].emplace_back(r * std::cos(angle), r * std::sin(angle),
                            height * static_cast<double>(i) / static_cast<double>(along));
    }
  }
  return tube(rings);
}

inline TriangleMesh sphere(double radius, std::size_t around, std::size_t along,
                           const Eigen::Vector3d& centre = Eigen::Vector3d::Zero()) {
  std::vector<std::vector<Eigen::Vector3d>> rings(along - 1);
  for (std::size_t i = 1; i < along; ++i) {
    const double polar = std::numbers::pi * (1 - static_cast<double>(i) / static_cast<double>(along));
    for (std::size_t k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(around);
      rings[i - 1].push_back(centre + radius * Eigen::Vector3d(std::sin(polar) * std::cos(angle),
                                                               std::sin(polar) * std::sin(angle), std::cos(polar)));
    }
  }
  TriangleMesh mesh = tube(rings);
  mesh.vertices.rightCols(2).col(0) = centre - radius * Eigen::Vector3d::UnitZ();
  mesh.vertices.rightCols(2).col(1) = centre + radius * Eigen::Vector3d::UnitZ();
  return mesh;
}

/// A twisted, tapered, cambered blade along z, about 20 x 6 x 40 mm.
inline TriangleMesh blade(std::size_t around, std::size_t along) {
  std::vector<std::vector<Eigen::Vector3d>> rings(along + 1);
  for (std::size_t i = 0; i <= along; ++i) {
    const double s = static_cast<double>(i) / static_cast<double>(along);
    const double chord = 10 - 3 * s, thickness = 1.6 - 0.7 * s, twist = 0.7 * s;
    for (std::size_t k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(around);
      const double x = chord * std::cos(angle);
      const double y = thickness * std::sin(angle) * (1 + 0.4 * std::cos(angle)) + 1.5 - 0.02 * x * x;
      rings[i].emplace_back(std::cos(twist) * x - std::sin(twist) * y, std::sin(twist) * x + std::cos(twist) * y,
                            40 * s);
    }
  }
  return tube(rings);
}

/// Each triangle becomes four in its plane.
inline TriangleMesh subdivided(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::size_t, 3>> triangles;
  for (Eigen::Index t = 0; t < mesh.size(); ++t) {
    const Eigen::Vector3d a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
    const std::size_t n = vertices.size();
    // The order of a sum must not depend on the triangle that the edge is seen from.
    vertices.insert(vertices.end(), {a, b, c, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5});
    triangles.insert(triangles.end(),
                     {{n, n + 3, n + 5}, {n + 3, n + 1, n + 4}, {n + 5, n + 4, n + 2}, {n + 3, n + 4, n + 5}});
  }
  return mesh_of(vertices, triangles);
}

/// Prism over a polygon without holes (anticlockwise in the xy plane, any shape), z from 0 to the height.
inline TriangleMesh prism(const std::vector<Eigen::Vector2d>& polygon, double height) {
  const std::size_t n = polygon.size();
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::size_t, 3>> triangles;
  for (const double z : {0.0, height}) {
    for (const Eigen::Vector2d& p : polygon) vertices.emplace_back(p.x(), p.y(), z);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    triangles.push_back({i, j, j + n});
    triangles.push_back({i, j + n, i + n});
  }
  const auto turn = [&](std::size_t a, std::size_t b, std::size_t c) {
    const Eigen::Vector2d u = polygon[b] - polygon[a], v = polygon[c] - polygon[a];
    return u.x() * v.y() - u.y() * v.x();
  };
  std::vector<std::size_t> left(n);
  for (std::size_t i = 0; i < n; ++i) left[i] = i;
  while (left.size() > 2) {  // ears are cut off
    for (std::size_t i = 0; i < left.size(); ++i) {
      const std::size_t a = left[(i + left.size() - 1) % left.size()], b = left[i], c = left[(i + 1) % left.size()];
      bool ear = turn(a, b, c) > 0;
      for (const std::size_t p : left) {
        ear = ear && (p == a || p == b || p == c || turn(a, b, p) < 0 || turn(b, c, p) < 0 || turn(c, a, p) < 0);
      }
      if (!ear) continue;
      triangles.push_back({a + n, b + n, c + n});
      triangles.push_back({a, c, b});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
      break;
    }
  }
  return mesh_of(vertices, triangles);
}

/// Three steps of different length and height, 50 x 30 x 24 mm; no rotation maps it onto itself.
inline TriangleMesh stepped_box(int subdivisions = 0) {
  TriangleMesh mesh = prism({{0, 0}, {50, 0}, {50, 6}, {38, 6}, {38, 17}, {20, 17}, {20, 30}, {0, 30}}, 24);
  for (int i = 0; i < subdivisions; ++i) mesh = subdivided(mesh);
  return mesh;
}

struct Sample {
  Eigen::Matrix3Xd points, normals;
};

/// Points spread at random over the area, in the order of their triangles.
/// @param keep  which points of the surface are visible
inline Sample sample(
    const TriangleMesh& mesh, Eigen::Index count, std::uint64_t seed,
    const std::function<bool(const Eigen::Vector3d& point, const Eigen::Vector3d& normal)>& keep =
        [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return true; }) {
  test::Numbers numbers(seed);
  std::vector<double> area{0};
  for (Eigen::Index t = 0; t < mesh.size(); ++t) {
    const Eigen::Vector3d a = mesh.corner(t, 0);
    area.push_back(area.back() + (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a).norm() / 2);
  }
  Sample result;
  result.points.resize(3, count);
  result.normals.resize(3, count);
  for (Eigen::Index i = 0; i < count;) {
    const double at = numbers.uniform(0, area.back());
    const auto above = std::upper_bound(area.begin(), area.end() - 1, at);
    const Eigen::Index t = static_cast<Eigen::Index>(above - area.begin()) - 1;
    double u = numbers.uniform(), v = numbers.uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Eigen::Vector3d a = mesh.corner(t, 0), ab = mesh.corner(t, 1) - a, ac = mesh.corner(t, 2) - a;
    const Eigen::Vector3d point = a + u * ab + v * ac, normal = ab.cross(ac).normalized();
    if (!keep(point, normal)) continue;
    result.points.col(i) = point;
    result.normals.col(i++) = normal;
  }
  return result;
}

}  // namespace abbe::parts
