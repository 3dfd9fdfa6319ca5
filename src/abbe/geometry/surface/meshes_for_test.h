#pragma once

#include <cmath>
#include <numbers>

#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// Closed block between two corners, 12 triangles, anticlockwise from outside.
inline TriangleMesh block_for_test(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 8);
  for (int i = 0; i < 8; ++i) {
    const auto at = [&](int k) { return (i >> k & 1) != 0 ? upper[k] : lower[k]; };
    mesh.vertices.col(i) = Eigen::Vector3d(at(0), at(1), at(2));
  }
  mesh.triangles.resize(3, 12);
  mesh.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      2, 3, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,                //
      3, 1, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  return mesh;
}

/// Closed sphere of `rings` x 2 `rings` meridians, with single poles.
inline TriangleMesh sphere_for_test(const Eigen::Vector3d& centre, double radius, int rings) {
  TriangleMesh mesh;
  const int meridians = 2 * rings;
  mesh.vertices.resize(3, meridians * (rings - 1) + 2);
  mesh.triangles.resize(3, 2 * meridians * (rings - 1));
  const auto at = [&](int ring, int meridian) -> std::uint32_t {
    if (ring == 0) return 0;
    if (ring == rings) return 1;
    return static_cast<std::uint32_t>(2 + (ring - 1) * meridians + meridian % meridians);
  };
  Eigen::Index next = 0;
  for (int ring = 0; ring <= rings; ++ring) {
    const double theta = std::numbers::pi * ring / rings;
    for (int meridian = 0; meridian < meridians; ++meridian) {
      const double phi = 2 * std::numbers::pi * meridian / meridians;
      mesh.vertices.col(at(ring, meridian)) =
          centre +
          radius * Eigen::Vector3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      if (ring == rings) continue;
      const std::uint32_t a = at(ring, meridian), b = at(ring + 1, meridian), c = at(ring + 1, meridian + 1),
                          d = at(ring, meridian + 1);
      if (b != c) mesh.triangles.col(next++) << a, b, c;
      if (a != d) mesh.triangles.col(next++) << a, c, d;
    }
  }
  return mesh;
}

/// Closed prism about y: `sides` flat sides, or a round one if there are many.
inline TriangleMesh prism_for_test(int sides, double radius, double low, double high) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(sides);
  mesh.vertices.resize(3, 2 * sides + 2);
  mesh.triangles.resize(3, 4 * sides);
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides + 0.3;
    mesh.vertices.col(i) = Eigen::Vector3d(radius * std::sin(angle), low, radius * std::cos(angle));
    mesh.vertices.col(n + i) = Eigen::Vector3d(radius * std::sin(angle), high, radius * std::cos(angle));
    const std::uint32_t j = (i + 1) % n;
    mesh.triangles.col(4 * i) << i, j, n + j;
    mesh.triangles.col(4 * i + 1) << i, n + j, n + i;
    mesh.triangles.col(4 * i + 2) << 2 * n, j, i;
    mesh.triangles.col(4 * i + 3) << 2 * n + 1, n + i, n + j;
  }
  mesh.vertices.col(2 * n) = Eigen::Vector3d(0, low, 0);
  mesh.vertices.col(2 * n + 1) = Eigen::Vector3d(0, high, 0);
  return mesh;
}

}  // namespace abbe
