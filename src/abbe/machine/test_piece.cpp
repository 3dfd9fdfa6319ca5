#include "abbe/machine/test_piece.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/geometry/angle_units.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

bool positive(double value) { return std::isfinite(value) && value > 0; }

/// Sets the tool beside a ruling.
CurvePoint beside(const Ruling& ruling, double tool_radius, double feed) {
  const Vector3d foot = ruling.foot + tool_radius * ruling.foot_normal;
  const Vector3d head = ruling.head + tool_radius * ruling.head_normal;
  CurvePoint point;
  point.point = foot;
  point.direction = (head - foot).normalized();
  point.feed = feed;
  return point;
}

void add(TestPiece& piece, const Ruling& ruling, double feed) {
  piece.rulings.push_back(ruling);
  piece.curve.points.push_back(beside(ruling, piece.tool_radius, feed));
  piece.curve.points.back().working = piece.curve.points.size() > 1;
}

/// More points than a control takes; a program of them would be some 100 MB.
constexpr double kMostPieces = 1e6;

/// @throws std::invalid_argument if it is not finite or so large that the sizes are mistaken
std::size_t count_of(double wanted, std::size_t least) {
  if (!(wanted <= kMostPieces)) {
    throw std::invalid_argument("test piece: a tolerance for which a million points are enough");
  }
  return std::max(least, static_cast<std::size_t>(std::ceil(wanted)));
}

/// Pieces of equal parameter over a curve of so much turning and such a radius, each within the tolerance of its chord.
std::size_t pieces(double turning, double radius, double tolerance) {
  // Sagitta r (1 - cos(a / 2)) of an arc of the angle a.
  const double angle = 2 * std::acos(std::max(0.0, 1 - tolerance / radius));
  return count_of(turning / angle, 8);
}

/// The S with what its normals need.
struct SWall {
  const SShape& shape;

  /// A horizontal vector turned by a quarter to the right: out of the material.
  static Vector3d across(const Vector3d& v) { return {v.y(), -v.x(), 0}; }
  Vector3d foot(double s) const { return {shape.length * (s - 0.5), shape.amplitude * std::sin(kTurn * s), 0}; }
  Vector3d tangent(double s) const { return {shape.length, kTurn * shape.amplitude * std::cos(kTurn * s), 0}; }
  double lean(double s) const { return shape.lean * std::cos(kTurn * s) + shape.twist * std::sin(kTurn * s); }
  Vector3d ruling(double s) const {
    return shape.height * (std::tan(lean(s)) * across(tangent(s).normalized()) + Vector3d::UnitZ());
  }
  /// Derivative by s of a point at the height h (0 to 1) of the ruling.
  Vector3d along(double s, double h) const {
    const Vector3d t = tangent(s), unit = t.normalized();
    const Vector3d bend(0, -kTurn * kTurn * shape.amplitude * std::sin(kTurn * s), 0);
    const Vector3d turning = (bend - unit.dot(bend) * unit) / t.norm();
    const double tangent_of_lean = std::tan(lean(s));
    const double leaning = (1 + tangent_of_lean * tangent_of_lean) * kTurn *
                           (shape.twist * std::cos(kTurn * s) - shape.lean * std::sin(kTurn * s));
    return t + h * shape.height * (leaning * across(unit) + tangent_of_lean * across(turning));
  }
  Vector3d normal(double s, double h) const { return along(s, h).cross(ruling(s)).normalized(); }
};

}  // namespace

TestPiece cone_frustum(const ConeFrustum& f) {
  const double radius = f.base_diameter / 2;
  if (!positive(f.base_diameter) || !positive(f.height) || !positive(f.tool_radius) || !positive(f.feed) ||
      !positive(f.chord_tolerance) || !(f.half_apex_angle > 0) || !(f.half_apex_angle < kTurn / 4) ||
      !(f.inclination >= 0) || !(f.inclination < kTurn / 4) || !std::isfinite(f.lean_azimuth) ||
      !f.base_centre.allFinite() || !(f.height * std::tan(f.half_apex_angle) < radius)) {
    throw std::invalid_argument(
        "cone frustum: a base, a height below the apex, angles between 0 and 90 degrees, a tool, a feed and a "
        "tolerance");
  }
  TestPiece piece;
  piece.tool_radius = f.tool_radius;
  // Leaning from +Z towards the azimuth is a turn about the horizontal direction 90 degrees ahead of it.
  const Eigen::Matrix3d table_from_cone =
      (Eigen::AngleAxisd(f.inclination, Vector3d(-std::sin(f.lean_azimuth), std::cos(f.lean_azimuth), 0)))
          .toRotationMatrix();
  const double top = radius - f.height * std::tan(f.half_apex_angle);
  const double slope_cosine = std::cos(f.half_apex_angle), slope_sine = std::sin(f.half_apex_angle);
  const std::size_t count = pieces(kTurn, radius + f.tool_radius, f.chord_tolerance);
  for (std::size_t k = 0; k <= count; ++k) {
    const double angle = k == count ? 0 : kTurn * static_cast<double>(k) / static_cast<double>(count);
    const Vector3d out(std::cos(angle), std::sin(angle), 0);
    Ruling ruling;
    ruling.foot = f.base_centre + table_from_cone * (radius * out);
    ruling.head = f.base_centre + table_from_cone * (top * out + f.height * Vector3d::UnitZ());
    ruling.foot_normal = ruling.head_normal = table_from_cone * (slope_cosine * out + slope_sine * Vector3d::UnitZ());
    add(piece, ruling, f.feed);
  }
  return piece;
}

TestPiece s_shape(const SShape& shape) {
  if (!positive(shape.length) || !positive(shape.height) || !positive(shape.tool_radius) || !positive(shape.feed) ||
      !positive(shape.chord_tolerance) || !std::isfinite(shape.amplitude) || !std::isfinite(shape.azimuth) ||
      !shape.centre.allFinite() || !(std::abs(shape.lean) + std::abs(shape.twist) < kTurn / 8)) {
    throw std::invalid_argument(
        "S shape: a length, a height, a lean and twist below 45 degrees together, a tool, a feed and a tolerance");
  }
  // The sine is bent most at its crests: curvature amplitude (2 pi / length)^2.
  const double curvature = std::abs(shape.amplitude) * std::pow(kTurn / shape.length, 2);
  if (curvature * shape.tool_radius >= 1) {
    throw std::invalid_argument("S shape: a tool of a smaller radius than its crests have");
  }
  TestPiece piece;
  piece.tool_radius = shape.tool_radius;
  const SWall wall{shape};
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(shape.azimuth, Vector3d::UnitZ()).toRotationMatrix();
  const auto tool_at = [&](double s) -> Vector3d { return wall.foot(s) + shape.tool_radius * wall.normal(s, 0); };
  // The sagitta of n equal pieces is |second derivative| / (8 n^2); the largest one of a thousand second differences
  // is nearly that, as the curve is smooth over a thousandth of its length.
  constexpr int kSamples = 1000;
  constexpr double kStep = 1.0 / kSamples;
  double bend = 0;
  for (int k = 1; k < kSamples; ++k) {
    const double s = k * kStep;
    bend = std::max(bend, (tool_at(s - kStep) - 2 * tool_at(s) + tool_at(s + kStep)).norm() / (kStep * kStep));
  }
  const double wanted = 1.01 * std::sqrt(bend / (8 * shape.chord_tolerance));
  const std::size_t count = count_of(wanted, 16);
  for (std::size_t k = 0; k <= count; ++k) {
    const double s = static_cast<double>(k) / static_cast<double>(count);
    Ruling ruling;
    ruling.foot = shape.centre + turn * wall.foot(s);
    ruling.head = ruling.foot + turn * wall.ruling(s);
    ruling.foot_normal = turn * wall.normal(s, 0);
    ruling.head_normal = turn * wall.normal(s, 1);
    add(piece, ruling, shape.feed);
  }
  return piece;
}

}  // namespace abbe
