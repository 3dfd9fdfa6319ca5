#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <vector>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/fits/numbers_for_test.h"
#include "abbe/geometry/fits/shapes.h"
#include "abbe/geometry/rotation.h"

namespace abbe::test {

/// How near docs/fits.md says that a fit comes to the optimum.
inline constexpr double kFitLength = 1e-7;  ///< mm
inline constexpr double kFitAngle = 1e-9;   ///< rad

/// A shape with points on a part of it: their feet, the normals there, and what residuals must be orthogonal to.
struct Patch {
  Shape shape;
  Eigen::Matrix3Xd feet, normals;
  Eigen::Matrix3Xd second;  ///< line3, circle3: the other normal
  Eigen::MatrixXd basis;    ///< [n, parameters] what the distances do to first order when the shape moves
};

struct PatchOptions {
  Eigen::Index points = 300;
  double radius = 20, length = 40, half_angle = 0.3;
  double arc = 2 * std::numbers::pi;  ///< rad
  double far = 0;                     ///< distance from the origin, mm
  bool hold_radius = false, hold_direction = false, hold_half_angle = false;
};

/// A patch anywhere in space. The basis is written down from geometry, not taken from the fits: a circle's distances
/// change by 1, cos, sin; a cylinder's also by z cos, z sin; a cone's also by z; a plane's by 1, x, y.
inline Patch patch(ShapeKind kind, const PatchOptions& o, Numbers& numbers) {
  Patch p;
  p.shape.kind = kind;
  const bool in_plane = kind == ShapeKind::line2 || kind == ShapeKind::circle2;
  const double turn = numbers.uniform(-3, 3);
  const Eigen::Matrix3d axes = in_plane ? rotation_about(Eigen::Vector3d::UnitZ(), turn)
                                        : rotation_from_vector(numbers.uniform(0.1, 3) * numbers.direction());
  Eigen::Vector3d place = o.far * numbers.direction() + 10 * numbers.direction();
  if (in_plane) place.z() = 0;
  p.shape.point = place;
  p.shape.direction = kind == ShapeKind::line2 ? axes.col(0) : axes.col(2);
  if (kind == ShapeKind::sphere) p.shape.direction.setZero();
  if (kind >= ShapeKind::circle2) p.shape.radius = o.radius;
  if (kind == ShapeKind::cone) p.shape.half_angle = o.half_angle;
  p.feet.resize(3, o.points);
  p.normals.resize(3, o.points);
  p.second = Eigen::Matrix3Xd::Zero(3, o.points);
  std::vector<Eigen::VectorXd> columns(6, Eigen::VectorXd::Zero(o.points));
  std::size_t used = 0;
  for (Eigen::Index i = 0; i < o.points; ++i) {
    const double t = numbers.uniform(-0.5, 0.5) * o.arc, z = numbers.uniform(-0.5, 0.5) * o.length;
    const double x = numbers.uniform(-0.5, 0.5) * 1.7 * o.length;
    const double c = std::cos(t), s = std::sin(t);
    Eigen::Vector3d foot(0, 0, 0), normal(0, 0, 1), second(0, 0, 0);
    std::vector<double> row;
    switch (kind) {
      case ShapeKind::line2:
        foot = {x, 0, 0};
        normal = {0, 1, 0};
        row = {1, x};
        break;
      case ShapeKind::line3:
        foot = {0, 0, x};
        normal = {1, 0, 0};
        second = {0, 1, 0};
        row = {1, x};
        break;
      case ShapeKind::plane:
        foot = {x, z, 0};
        row = {1, x, z};
        break;
      case ShapeKind::circle2:
      case ShapeKind::circle3:
        foot = {o.radius * c, o.radius * s, 0};
        normal = {c, s, 0};
        // With the radius held, what is across the plane would need the constant that the rest does not.
        if (kind == ShapeKind::circle3 && !o.hold_radius) second = {0, 0, 1};
        row = {c, s, 1};
        break;
      case ShapeKind::sphere: {
        // A cap of that opening angle.
        const double h = 1 - (1 - std::cos(o.arc / 2)) * numbers.uniform(0, 1), turn_about = numbers.uniform(0, 6.3);
        const double w = std::sqrt(1 - h * h);
        normal = {w * std::cos(turn_about), w * std::sin(turn_about), h};
        foot = o.radius * normal;
        row = {normal.x(), normal.y(), normal.z(), 1};
        break;
      }
      case ShapeKind::cylinder:
        foot = {o.radius * c, o.radius * s, z};
        normal = {c, s, 0};
        row = {c, s, z * c, z * s, 1};
        break;
      case ShapeKind::cone: {
        const double across = o.radius + z * std::tan(o.half_angle);
        foot = {across * c, across * s, z};
        normal = {std::cos(o.half_angle) * c, std::cos(o.half_angle) * s, -std::sin(o.half_angle)};
        row = {c, s, z * c, z * s, 1, z};
        break;
      }
    }
    // What is held needs no orthogonality. Turning a cone or cylinder about its point: z cos, z sin (and cos, sin).
    if (o.hold_half_angle) row.erase(row.begin() + 5);
    if (o.hold_radius) row.pop_back();
    if (o.hold_direction && kind == ShapeKind::cylinder) row.erase(row.begin() + 2, row.begin() + 4);
    if (o.hold_direction && kind == ShapeKind::plane) row.resize(1);
    used = row.size();
    for (std::size_t k = 0; k < used; ++k) columns[k][i] = row[k];
    p.feet.col(i) = place + axes * foot;
    p.normals.col(i) = axes * normal;
    p.second.col(i) = axes * second;
  }
  p.basis.resize(o.points, static_cast<Eigen::Index>(used));
  for (std::size_t k = 0; k < used; ++k) p.basis.col(static_cast<Eigen::Index>(k)) = columns[k];
  return p;
}

/// Random residuals of that size, orthogonal to the basis: the shape of the patch is the least-squares shape, exactly.
inline Eigen::VectorXd orthogonal_residuals(const Patch& p, double size, Numbers& numbers) {
  Eigen::VectorXd d(p.basis.rows());
  for (Eigen::Index i = 0; i < d.size(); ++i) d[i] = size * numbers.normal();
  const Eigen::MatrixXd q = Qr(p.basis).orthonormal(p.basis.cols());
  for (int pass = 0; pass < 2; ++pass) d -= q * (q.transpose() * d);
  return d;
}

/// Points whose least-squares shape is that of the patch.
inline Eigen::Matrix3Xd with_orthogonal_residuals(const Patch& p, double size, Numbers& numbers) {
  const Eigen::VectorXd first = orthogonal_residuals(p, size, numbers), second = orthogonal_residuals(p, size, numbers);
  return p.feet + p.normals * first.asDiagonal() + p.second * second.asDiagonal();
}

/// How far apart two shapes of one kind are: offset across what does not matter and radius (mm), angles (rad).
struct ShapeDifference {
  double length = 0, angle = 0;
};
inline ShapeDifference difference(const Shape& a, const Shape& b) {
  ShapeDifference result;
  Eigen::Vector3d between = a.point - b.point;
  const Eigen::Vector3d& d = b.direction;
  double radius = a.radius;
  switch (b.kind) {
    case ShapeKind::plane:
      between = between.dot(d) * d;
      break;
    case ShapeKind::line2:
    case ShapeKind::line3:
    case ShapeKind::cylinder:
      between -= between.dot(d) * d;
      break;
    case ShapeKind::cone:
      radius -= between.dot(a.direction) * std::tan(a.half_angle);
      between -= between.dot(d) * d;
      break;
    default:
      break;
  }
  result.length = std::max(between.norm(), std::abs(radius - b.radius));
  result.angle = std::max(a.direction.cross(d).norm(), std::abs(a.half_angle - b.half_angle));
  return result;
}

inline const std::vector<ShapeKind>& all_kinds() {
  static const std::vector<ShapeKind> kinds = {ShapeKind::line2,    ShapeKind::line3,   ShapeKind::plane,
                                               ShapeKind::circle2,  ShapeKind::circle3, ShapeKind::sphere,
                                               ShapeKind::cylinder, ShapeKind::cone};
  return kinds;
}

}  // namespace abbe::test
