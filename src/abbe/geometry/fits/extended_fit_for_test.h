#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "abbe/geometry/fits/shapes.h"

/// A second way to the shapes, which shares nothing with the library's: extended precision, derivatives by differences
/// of the plain distance, parameters with all their redundancy.
namespace abbe::test {

using Extended = long double;
using ExtendedVector = Eigen::Matrix<Extended, Eigen::Dynamic, 1>;
using ExtendedMatrix = Eigen::Matrix<Extended, Eigen::Dynamic, Eigen::Dynamic>;
using Extended3 = Eigen::Matrix<Extended, 3, 1>;

/// Point, direction of any length, radius, half angle.
using ExtendedShape = Eigen::Matrix<Extended, 8, 1>;

/// Points about the first of them, which loses nothing.
struct ExtendedPoints {
  Eigen::Matrix<Extended, 3, Eigen::Dynamic> points;
  Eigen::Vector3d first;

  explicit ExtendedPoints(const Eigen::Matrix3Xd& all)
      : points(all.cast<Extended>().colwise() - Extended3(all.col(0).cast<Extended>())), first(all.col(0)) {}

  ExtendedShape from(const Shape& shape) const {
    ExtendedShape result;
    result << (shape.point.cast<Extended>() - first.cast<Extended>()), shape.direction.cast<Extended>(),
        static_cast<Extended>(shape.radius), static_cast<Extended>(shape.half_angle);
    return result;
  }
  Shape to(ShapeKind kind, const ExtendedShape& s) const {
    Shape result;
    result.kind = kind;
    result.point = (s.head<3>() + first.cast<Extended>()).cast<double>();
    if (s.segment<3>(3).norm() > 0) result.direction = s.segment<3>(3).normalized().cast<double>();
    result.radius = static_cast<double>(s[6]);
    result.half_angle = static_cast<double>(s[7]);
    return result;
  }
};

/// Residuals of a point whose squares add up to that of its distance; unused ones are zero.
inline Extended3 extended_residuals(ShapeKind kind, const ExtendedShape& s, const Extended3& point) {
  const Extended3 q = point - s.head<3>();
  if (kind == ShapeKind::sphere) return {q.norm() - s[6], 0, 0};
  const Extended3 u = s.segment<3>(3).normalized();
  const Extended along = q.dot(u), across = (q - along * u).norm();
  switch (kind) {
    case ShapeKind::line3:
      return q - along * u;
    case ShapeKind::plane:
      return {along, 0, 0};
    case ShapeKind::circle3:
      return {along, across - s[6], 0};
    case ShapeKind::cone:
      return {(across - s[6]) * std::cos(s[7]) - along * std::sin(s[7]), 0, 0};
    default:
      return {across - s[6], 0, 0};
  }
}

/// Columns: derivatives by the eight parameters, by differences of fourth order.
template <class Function>
ExtendedMatrix extended_slopes(const Function& function, const ExtendedShape& at) {
  ExtendedMatrix slopes;
  for (int k = 0; k < 8; ++k) {
    const Extended step = k < 3 || k == 6 ? 1e-3L : 1e-4L;
    const auto value = [&](int steps) {
      ExtendedShape moved = at;
      moved[k] += static_cast<Extended>(steps) * step;
      return ExtendedVector(function(moved));
    };
    const ExtendedVector slope = (8 * (value(1) - value(-1)) - (value(2) - value(-2))) / (12 * step);
    if (k == 0) slopes.resize(slope.size(), 8);
    slopes.col(k) = slope;
  }
  return slopes;
}

/// Levenberg and Marquardt: sum of squared distances, from a start near by.
inline ExtendedShape extended_least_squares(ShapeKind kind, const ExtendedPoints& data, ExtendedShape at) {
  const auto residuals = [&](const ExtendedShape& s) {
    ExtendedVector all(3 * data.points.cols());
    for (Eigen::Index i = 0; i < data.points.cols(); ++i) {
      all.segment<3>(3 * i) = extended_residuals(kind, s, data.points.col(i));
    }
    return all;
  };
  Extended damping = 1e-6L, sum = residuals(at).squaredNorm();
  for (int iteration = 0; iteration < 100; ++iteration) {
    const ExtendedMatrix slopes = extended_slopes(residuals, at);
    ExtendedMatrix normal = slopes.transpose() * slopes;
    const ExtendedVector gradient = slopes.transpose() * residuals(at);
    // What the data do not determine (length of the direction, point along the axis) stays where it is.
    const Extended largest = normal.diagonal().maxCoeff();
    normal.diagonal().array() += std::max(damping, 1e-15L) * largest;
    const ExtendedShape next = at - normal.ldlt().solve(gradient);
    const Extended reached = residuals(next).squaredNorm();
    const Extended step = (next - at).norm();
    // At rounding the sum says nothing about a step any more.
    if (reached <= sum * (1 + 1e-17L)) {
      at = next;
      sum = std::min(sum, reached);
      damping /= 10;
      if (step < 1e-15L) break;
    } else {
      damping = std::max(10 * damping, 1e-12L);
    }
  }
  return at;
}

/// Newton's method on: signed distances of some points equal. For as many points as the shape has parameters and one.
/// @param signs  [points]
inline ExtendedShape extended_contact_shape(ShapeKind kind, const ExtendedPoints& data,
                                            const std::vector<Eigen::Index>& contacts, const std::vector<int>& signs,
                                            ExtendedShape at) {
  const auto distances = [&](const ExtendedShape& s) {
    ExtendedVector all(static_cast<Eigen::Index>(contacts.size()));
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      all[static_cast<Eigen::Index>(k)] =
          static_cast<Extended>(signs[k]) * extended_residuals(kind, s, data.points.col(contacts[k]))[0];
    }
    return all;
  };
  for (int iteration = 0; iteration < 12; ++iteration) {
    const ExtendedVector values = distances(at);
    ExtendedMatrix system(values.size(), 9);
    system << extended_slopes(distances, at), -ExtendedVector::Ones(values.size());
    Eigen::CompleteOrthogonalDecomposition<ExtendedMatrix> shortest;
    shortest.setThreshold(1e-12L);
    shortest.compute(system);
    at -= ExtendedVector(shortest.solve(values)).head<8>();
  }
  return at;
}

}  // namespace abbe::test
