#include "abbe/geometry/fits/simulated_shapes_for_test.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/rotation.h"

namespace abbe::test {
namespace {

/// Any shape in its own axes: e3 is its direction (line2: e1 along it), the origin its point.
struct PointOfShape {
  Eigen::Vector3d foot, normal, second = Eigen::Vector3d::Zero();
};

/// Residuals of a foot by what the shape may do: shifts and tilts about the middle, radius, half angle; lengths in
/// units of `size`. Written down from geometry; see docs/fits.md.
void append_slopes(const Shape& shape, const PointOfShape& p, double size, std::vector<Eigen::VectorXd>& rows) {
  const auto row = [&](const Eigen::Vector3d& n, double by_radius, double by_angle) {
    const Eigen::Vector3d q = p.foot / size, moment = q.cross(n);
    Eigen::VectorXd r(7);
    r << -n, -moment.x(), -moment.y(), by_radius, by_angle;
    switch (shape.kind) {
      case ShapeKind::line2:
        rows.push_back(Eigen::Vector2d(-n.y(), -moment.z()));
        return;
      case ShapeKind::line3:
        rows.push_back(Eigen::Vector4d(r[0], r[1], r[3], r[4]));
        return;
      case ShapeKind::plane:
        rows.push_back(Eigen::Vector3d(r[2], r[3], r[4]));
        return;
      case ShapeKind::circle2:
        rows.push_back(Eigen::Vector3d(r[0], r[1], r[5]));
        return;
      case ShapeKind::circle3:
        rows.emplace_back(r.head<6>());
        return;
      case ShapeKind::sphere:
        rows.push_back(Eigen::Vector4d(r[0], r[1], r[2], r[5]));
        return;
      case ShapeKind::cylinder:
        rows.emplace_back(5);
        rows.back() << r[0], r[1], r[3], r[4], r[5];
        return;
      case ShapeKind::cone:
        rows.emplace_back(6);
        rows.back() << r[0], r[1], r[3], r[4], r[5], r[6];
        return;
    }
  };
  if (shape.kind == ShapeKind::line3 || shape.kind == ShapeKind::circle3) {
    row(p.normal, shape.kind == ShapeKind::circle3 ? -1 : 0, 0);
    row(p.second, 0, 0);
  } else if (shape.kind == ShapeKind::cone) {
    const double across = std::hypot(p.foot.x(), p.foot.y()) - shape.radius;
    const double cosine = std::cos(shape.half_angle), sine = std::sin(shape.half_angle);
    row(p.normal, -cosine, -(across * sine + p.foot.z() * cosine) / size);
  } else {
    row(p.normal, shape.kind >= ShapeKind::circle2 ? -1 : 0, 0);
  }
}

}  // namespace

SimulatedSet simulated_set(ShapeKind kind, Numbers& numbers, bool closed) {
  constexpr double kPi = std::numbers::pi;
  const bool in_plane = kind == ShapeKind::line2 || kind == ShapeKind::circle2;
  SimulatedSet set;
  const auto n = static_cast<Eigen::Index>(8 + numbers.below(23));
  set.size = std::pow(10, numbers.uniform(0, 4));
  set.noise = numbers.uniform() < 0.1 ? 0 : std::pow(10, numbers.uniform(-5, -1));
  set.far = numbers.uniform() < 0.5 ? 0 : 1e6;
  // A part of any proportions: from flat rings and large discs to long pins.
  const double aspect = std::pow(10, numbers.uniform(-1, 1));
  const double width = set.size * std::min(1.0, aspect), length = set.size * std::min(1.0, 1 / aspect);
  const double arc = closed || numbers.uniform() < 0.5 ? 2 * kPi : numbers.uniform(0.7, 2 * kPi);
  set.truth.kind = kind;
  if (kind >= ShapeKind::circle2) set.truth.radius = width / 2;
  if (kind == ShapeKind::cone) {
    set.truth.half_angle = numbers.uniform(0.05, 1.2);
    // The narrow end stays away from the apex.
    set.truth.radius = width / 2 + 0.6 * length * std::tan(set.truth.half_angle);
  }
  Shape& shape = set.truth;
  std::vector<PointOfShape> feet;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = numbers.uniform(-0.5, 0.5) * arc, c = std::cos(t), s = std::sin(t);
    const double along = numbers.uniform(-0.5, 0.5) * length, across = numbers.uniform(-0.5, 0.5) * width;
    const double r = shape.radius;
    switch (kind) {
      case ShapeKind::line2:
        feet.push_back({{numbers.uniform(-0.5, 0.5) * set.size, 0, 0}, {0, 1, 0}});
        break;
      case ShapeKind::line3:
        feet.push_back({{0, 0, numbers.uniform(-0.5, 0.5) * set.size}, {1, 0, 0}, {0, 1, 0}});
        break;
      case ShapeKind::plane:
        feet.push_back({{along, across, 0}, {0, 0, 1}});
        break;
      case ShapeKind::circle2:
        feet.push_back({{r * c, r * s, 0}, {c, s, 0}});
        break;
      case ShapeKind::circle3:
        feet.push_back({{r * c, r * s, 0}, {c, s, 0}, {0, 0, 1}});
        break;
      case ShapeKind::sphere: {
        // A cap of that opening angle.
        const double h = 1 - (1 - std::cos(arc / 2)) * numbers.uniform(), w = std::sqrt(std::max(0.0, 1 - h * h));
        const double turn = numbers.uniform(0, 2 * kPi);
        const Eigen::Vector3d normal(w * std::cos(turn), w * std::sin(turn), h);
        feet.push_back({r * normal, normal});
        break;
      }
      case ShapeKind::cylinder:
        feet.push_back({{r * c, r * s, along}, {c, s, 0}});
        break;
      case ShapeKind::cone: {
        const double at = r + along * std::tan(shape.half_angle);
        const double cosine = std::cos(shape.half_angle), sine = std::sin(shape.half_angle);
        feet.push_back({{at * c, at * s, along}, {cosine * c, cosine * s, -sine}});
        break;
      }
    }
  }
  const double turn = numbers.uniform(-kPi, kPi);
  const Eigen::Matrix3d axes =
      in_plane ? rotation_about(Eigen::Vector3d::UnitZ(), turn) : rotation_from_vector(turn * numbers.direction());
  Eigen::Vector3d place = (set.far + 0.3 * set.size) * numbers.direction();
  if (in_plane) place.z() = 0;
  std::vector<Eigen::VectorXd> rows;
  set.points.resize(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const PointOfShape& p = feet[static_cast<std::size_t>(i)];
    append_slopes(shape, p, set.size, rows);
    const double first = numbers.normal(), second = numbers.normal();
    set.points.col(i) = place + axes * (p.foot + set.noise * (first * p.normal + second * p.second));
  }
  if (in_plane) set.points.row(2).setZero();
  shape.point = place;
  shape.direction = kind == ShapeKind::line2    ? axes.col(0)
                    : kind == ShapeKind::sphere ? Eigen::Vector3d(0, 0, 0)
                                                : axes.col(2);
  set.slopes.resize(static_cast<Eigen::Index>(rows.size()), rows.front().size());
  for (std::size_t k = 0; k < rows.size(); ++k) set.slopes.row(static_cast<Eigen::Index>(k)) = rows[k].transpose();
  // Standard uncertainties in units of the size and rad.
  const double relative = std::hypot(set.noise, 2e-16 * set.far) / set.size;
  const Eigen::MatrixXd covariance =
      relative * relative * CompleteOrthogonal(set.slopes.transpose() * set.slopes).pseudo_inverse();
  const Eigen::VectorXd u = covariance.diagonal().cwiseMax(0).cwiseSqrt();
  set.uncertainty = u.maxCoeff();
  if (kind == ShapeKind::circle2) set.uncertainty = std::max(set.uncertainty, u[2] * set.size / shape.radius);
  if (kind == ShapeKind::circle3) set.uncertainty = std::max(set.uncertainty, u[5] * set.size / shape.radius);
  if (kind == ShapeKind::sphere) set.uncertainty = std::max(set.uncertainty, u[3] * set.size / shape.radius);
  if (kind == ShapeKind::cylinder) set.uncertainty = std::max(set.uncertainty, u[4] * set.size / shape.radius);
  return set;
}

}  // namespace abbe::test
