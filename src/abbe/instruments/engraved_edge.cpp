#include "abbe/instruments/engraved_edge.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace abbe {
namespace {

constexpr int kArc = 48;      // pieces of a rounding: 2 nm off a radius of 15 um
constexpr int kSurface = 24;  // pieces of a curved surface: 1 nm off a radius of 500 mm over half a millimetre

/// Left side of an engraving: surface, rounding, wall, down to the bottom.
std::vector<Eigen::Vector2d> left_side(const EngravedEdge& edge, double from) {
  const auto height = [&](double u) { return -edge.surface_curvature * u * u / 2; };
  const Eigen::Vector2d wall(-std::sin(edge.beam_tilt), -std::cos(edge.beam_tilt));
  // Over a rounding the surface is straight to a millionth of a millimetre.
  const double slope = std::atan(-edge.surface_curvature * edge.corner.x());
  const Eigen::Vector2d surface(std::cos(slope), std::sin(slope));
  const double turn = std::acos(std::clamp(surface.dot(wall), -1.0, 1.0));
  const Eigen::Vector2d first = edge.corner - edge.radius * std::tan(turn / 2) * surface;
  const Eigen::Vector2d inwards(surface.y(), -surface.x());
  const Eigen::Vector2d centre = first + edge.radius * inwards;
  std::vector<Eigen::Vector2d> points;
  // The surface through the corner, whatever its height at u = 0.
  const double lift = edge.corner.y() - height(edge.corner.x());
  for (int i = 0; i < kSurface; ++i) {
    const double u = from + (first.x() - from) * i / kSurface;
    points.emplace_back(u, height(u) + lift);
  }
  for (int i = 0; i <= kArc; ++i) {
    const double angle = turn * i / kArc;
    points.push_back(centre - edge.radius * (std::cos(angle) * inwards - std::sin(angle) * surface));
  }
  points.push_back(edge.corner + wall * (edge.depth / -wall.y()));
  return points;
}

}  // namespace

Eigen::Matrix2Xd engraved_profile(const EngravedEdge& edge, double half_width) {
  std::vector<Eigen::Vector2d> points = left_side(edge, -half_width);
  if (edge.groove_width > 0) {
    // The other side is a left side seen in a mirror at u = 0.
    EngravedEdge other = edge;
    const double right = edge.corner.x() + edge.groove_width;
    const double fall = edge.surface_curvature * (edge.corner.x() * edge.corner.x() - right * right) / 2;
    other.corner = {-right, edge.corner.y() + fall};
    other.beam_tilt = -edge.beam_tilt;
    other.depth = edge.depth + fall;
    const std::vector<Eigen::Vector2d> mirrored = left_side(other, -half_width);
    for (std::size_t i = mirrored.size(); i-- > 0;) points.emplace_back(-mirrored[i].x(), mirrored[i].y());
  } else {
    points.emplace_back(half_width, edge.corner.y() - edge.depth);
  }
  Eigen::Matrix2Xd profile(2, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) profile.col(static_cast<Eigen::Index>(i)) = points[i];
  return profile;
}

TriangleMesh engraved_mesh(const EngravedEdge& edge, double half_width, double half_length) {
  const Eigen::Matrix2Xd profile = engraved_profile(edge, half_width);
  const Eigen::Index n = profile.cols();
  TriangleMesh mesh;
  mesh.vertices.resize(3, 2 * n);
  mesh.triangles.resize(3, 2 * (n - 1));
  for (Eigen::Index i = 0; i < n; ++i) {
    mesh.vertices.col(2 * i) << profile(0, i), -half_length, profile(1, i);
    mesh.vertices.col(2 * i + 1) << profile(0, i), half_length, profile(1, i);
  }
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    const auto at = static_cast<std::uint32_t>(2 * i);
    mesh.triangles.col(2 * i) << at, at + 2, at + 3;
    mesh.triangles.col(2 * i + 1) << at, at + 3, at + 1;
  }
  return mesh;
}

}  // namespace abbe
