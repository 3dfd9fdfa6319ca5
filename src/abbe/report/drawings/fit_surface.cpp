#include "abbe/report/drawings/fit_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "abbe/report/drawings/deviation_colours.h"
#include "abbe/report/drawings/surface_picture.h"

namespace abbe {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Two unit vectors across a direction: direction, first, second are right-handed.
std::pair<Vector3d, Vector3d> across(const Vector3d& direction) {
  const Vector3d other = std::abs(direction.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY();
  const Vector3d first = (other - other.dot(direction) * direction).normalized();
  return {first, direction.cross(first)};
}

std::pair<double, double> range_along(const Vector3d& direction, const Vector3d& from, const Eigen::Matrix3Xd& points) {
  const Eigen::RowVectorXd along = direction.transpose() * (points.colwise() - from);
  return {along.minCoeff(), along.maxCoeff()};
}

/// A strip of rings about an axis, outwards: rings[i] = (place along the axis, radius).
TriangleMesh revolved(const Shape& shape, const std::vector<std::pair<double, double>>& rings) {
  constexpr std::uint32_t kAround = 144;
  const auto [first, second] = across(shape.direction);
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Index>(kAround * rings.size()));
  mesh.triangles.resize(3, static_cast<Index>(2 * kAround * (rings.size() - 1)));
  Index next = 0;
  for (std::uint32_t i = 0; i < rings.size(); ++i) {
    for (std::uint32_t k = 0; k < kAround; ++k) {
      const double angle = 2 * std::numbers::pi * k / kAround;
      mesh.vertices.col(i * kAround + k) = shape.point + rings[i].first * shape.direction +
                                           rings[i].second * (std::cos(angle) * first + std::sin(angle) * second);
      if (i + 1 == rings.size()) continue;
      const std::uint32_t a = i * kAround + k, b = i * kAround + (k + 1) % kAround;
      mesh.triangles.col(next++) << a, b, b + kAround;
      mesh.triangles.col(next++) << a, b + kAround, a + kAround;
    }
  }
  return mesh;
}

TriangleMesh rectangle(const Shape& plane, const Eigen::Matrix3Xd& points) {
  const auto [first, second] = across(plane.direction);
  const auto [x0, x1] = range_along(first, plane.point, points);
  const auto [y0, y1] = range_along(second, plane.point, points);
  TriangleMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << plane.point + x0 * first + y0 * second, plane.point + x1 * first + y0 * second,
      plane.point + x1 * first + y1 * second, plane.point + x0 * first + y1 * second;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 0, 1, 2, 2, 3;
  return mesh;
}

/// Unit normal of the shape where a point lies nearest, away from its inside.
Vector3d normal_at(const Shape& shape, const Vector3d& point) {
  const Vector3d from = point - shape.point;
  if (shape.kind == ShapeKind::plane) return shape.direction;
  if (shape.kind == ShapeKind::sphere) return from.normalized();
  Vector3d radial = (from - from.dot(shape.direction) * shape.direction).normalized();
  if (shape.kind == ShapeKind::cylinder) return radial;
  return std::cos(shape.half_angle) * radial - std::sin(shape.half_angle) * shape.direction;
}

}  // namespace

TriangleMesh surface_of(const Shape& shape, const Eigen::Matrix3Xd& points) {
  if (points.cols() == 0) return {};
  if (shape.kind == ShapeKind::plane) return rectangle(shape, points);
  std::vector<std::pair<double, double>> rings;
  Shape axis = shape;
  if (shape.kind == ShapeKind::sphere) {
    axis.direction = Vector3d::UnitZ();
    for (int i = 0; i <= 72; ++i) {
      const double angle = std::numbers::pi * i / 72;
      rings.emplace_back(-shape.radius * std::cos(angle), shape.radius * std::sin(angle));
    }
  } else if (shape.kind == ShapeKind::cylinder || shape.kind == ShapeKind::cone) {
    const auto [from, to] = range_along(shape.direction, shape.point, points);
    const double slope = shape.kind == ShapeKind::cone ? std::tan(shape.half_angle) : 0;
    for (const double at : {from, to}) rings.emplace_back(at, std::max(0.0, shape.radius + at * slope));
  } else {
    return {};
  }
  return revolved(axis, rings);
}

nlohmann::json fit_page(const Shape& shape, const Eigen::Matrix3Xd& points, const std::vector<double>& deviations_mm,
                        const std::vector<std::uint8_t>& counted, int threads) {
  const TriangleMesh mesh = surface_of(shape, points);
  if (mesh.size() == 0) return nlohmann::json::object();
  std::vector<SurfacePoint> feet(deviations_mm.size());
  std::vector<double> amounts;
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const Vector3d point = points.col(static_cast<Index>(i)), normal = normal_at(shape, point);
    feet[i].point = point - deviations_mm[i] * normal;
    feet[i].normal = normal;
    feet[i].distance = deviations_mm[i];
    feet[i].on_border = counted[i] == 0;
    if (counted[i] != 0) amounts.push_back(deviations_mm[i]);
  }
  nlohmann::json page = deviation_page(mesh, feet, surface_deviation(feet), colour_range_mm(amounts), threads);
  // The plots of the fit say more than the distribution.
  page.erase("histograms");
  if (page.contains("surface")) page["surface"]["frame"] = "file";
  return page;
}

}  // namespace abbe
