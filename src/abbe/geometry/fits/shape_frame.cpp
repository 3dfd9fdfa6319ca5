#include "abbe/geometry/fits/shape_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "abbe/geometry/rotation.h"

namespace abbe::fits {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d axes_along(const Vector3d& direction) {
  Matrix3d axes;
  axes.col(2) = direction.normalized();
  int smallest = 0;
  axes.col(2).cwiseAbs().minCoeff(&smallest);
  axes.col(0) = axes.col(2).cross(Vector3d::Unit(smallest)).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

Matrix3d axes_of_line2(const Vector3d& direction) {
  const Vector3d d = Vector3d(direction.x(), direction.y(), 0).normalized();
  Matrix3d axes;
  axes << d, Vector3d(0, 0, -1), Vector3d(-d.y(), d.x(), 0);
  return axes;
}

ShapeFrame moved(const ShapeFrame& frame, const Step& step) {
  ShapeFrame result = frame;
  result.origin += frame.axes * step.head<3>();
  const Vector3d tilt(step[kTilt1], step[kTilt2], 0);
  if (tilt.squaredNorm() > 0) {
    result.axes = frame.axes * rotation_from_vector(tilt);
    // Rounding must not accumulate over many steps.
    result.axes.col(2).normalize();
    result.axes.col(0) =
        (result.axes.col(0) - result.axes.col(0).dot(result.axes.col(2)) * result.axes.col(2)).normalized();
    result.axes.col(1) = result.axes.col(2).cross(result.axes.col(0));
  }
  result.radius += step[kRadius];
  result.half_angle += step[kHalfAngle];
  return result;
}

void settle(ShapeFrame& frame, const Vector3d& centroid) {
  const Vector3d q = frame.axes.transpose() * (centroid - frame.origin);
  switch (frame.kind) {
    case ShapeKind::line2:
      frame.origin += q.x() * frame.axes.col(0);
      break;
    case ShapeKind::plane:
      frame.origin += q.x() * frame.axes.col(0) + q.y() * frame.axes.col(1);
      break;
    case ShapeKind::cone:
      frame.radius += q.z() * std::tan(frame.half_angle);
      [[fallthrough]];
    case ShapeKind::line3:
    case ShapeKind::cylinder:
      frame.origin += q.z() * frame.axes.col(2);
      break;
    default:
      break;
  }
}

Shape shape_of(ShapeFrame frame, const Vector3d& centroid) {
  settle(frame, centroid);
  Shape shape;
  shape.kind = frame.kind;
  shape.point = frame.centre + frame.origin;
  shape.direction = frame.axes.col(frame.kind == ShapeKind::line2 ? 0 : 2);
  if (frame.kind == ShapeKind::sphere) shape.direction.setZero();
  if (frame.kind == ShapeKind::line2 || frame.kind == ShapeKind::circle2) shape.point.z() = 0;
  if (has_radius(frame.kind)) shape.radius = frame.radius;
  if (frame.kind == ShapeKind::cone) {
    shape.half_angle = frame.half_angle;
    // The direction is that in which the cone opens.
    if (shape.half_angle < 0) {
      shape.half_angle *= -1;
      shape.direction *= -1;
    }
  } else if (has_direction(frame.kind)) {
    int largest = 0;
    shape.direction.cwiseAbs().maxCoeff(&largest);
    if (shape.direction[largest] < 0) shape.direction *= -1;
  }
  return shape;
}

std::vector<int> free_parameters(ShapeKind kind, const FitConstraints& constraints) {
  std::vector<int> free;
  switch (kind) {
    case ShapeKind::line2:
      free = {kShift3, kTilt2};
      break;
    case ShapeKind::line3:
      free = {kShift1, kShift2, kTilt1, kTilt2};
      break;
    case ShapeKind::plane:
      free = {kShift3, kTilt1, kTilt2};
      break;
    case ShapeKind::circle2:
      free = {kShift1, kShift2, kRadius};
      break;
    case ShapeKind::circle3:
      free = {kShift1, kShift2, kShift3, kTilt1, kTilt2, kRadius};
      break;
    case ShapeKind::sphere:
      free = {kShift1, kShift2, kShift3, kRadius};
      break;
    case ShapeKind::cylinder:
      free = {kShift1, kShift2, kTilt1, kTilt2, kRadius};
      break;
    case ShapeKind::cone:
      free = {kShift1, kShift2, kTilt1, kTilt2, kRadius, kHalfAngle};
      break;
  }
  std::erase_if(free, [&](int p) {
    return (constraints.radius && p == kRadius && kind != ShapeKind::cone) ||
           (constraints.direction && (p == kTilt1 || p == kTilt2)) || (constraints.half_angle && p == kHalfAngle);
  });
  return free;
}

PointSlopes point_slopes(const ShapeFrame& frame, const Vector3d& point) {
  const Vector3d q = frame.axes.transpose() * ((point - frame.centre) - frame.origin);
  const double across = std::max(std::hypot(q.x(), q.y()), 1e-300);
  const double c = q.x() / across, s = q.y() / across;
  PointSlopes result;
  Vector3d g = Vector3d::Zero();
  switch (frame.kind) {
    case ShapeKind::line2:
    case ShapeKind::plane:
      result.distance = q.z();
      g = {0, 0, 1};
      break;
    case ShapeKind::line3:
      result.distance = across;
      g = {c, s, 0};
      break;
    case ShapeKind::circle2:
    case ShapeKind::cylinder:
      result.distance = across - frame.radius;
      g = {c, s, 0};
      result.slope[kRadius] = -1;
      break;
    case ShapeKind::circle3: {
      const double d = std::max(std::hypot(q.z(), across - frame.radius), 1e-300);
      const double out = (across - frame.radius) / d;
      result.distance = d;
      g = {out * c, out * s, q.z() / d};
      result.slope[kRadius] = -out;
      break;
    }
    case ShapeKind::sphere:
      result.distance = q.norm() - frame.radius;
      g = q / std::max(q.norm(), 1e-300);
      result.slope[kRadius] = -1;
      break;
    case ShapeKind::cone: {
      const double cosine = std::cos(frame.half_angle), sine = std::sin(frame.half_angle);
      result.distance = (across - frame.radius) * cosine - q.z() * sine;
      g = {cosine * c, cosine * s, -sine};
      result.slope[kRadius] = -cosine;
      result.slope[kHalfAngle] = -(across - frame.radius) * sine - q.z() * cosine;
      break;
    }
  }
  const Vector3d moment = q.cross(g);
  result.slope.head<3>() = -g;
  result.slope[kTilt1] = -moment.x();
  result.slope[kTilt2] = -moment.y();
  return result;
}

std::array<PointSlopes, 2> point_components(const ShapeFrame& frame, const Vector3d& point) {
  const Vector3d q = frame.axes.transpose() * ((point - frame.centre) - frame.origin);
  std::array<PointSlopes, 2> parts;
  const auto enter = [&](PointSlopes& part, double distance, const Vector3d& g) {
    const Vector3d moment = q.cross(g);
    part.distance = distance;
    part.slope.head<3>() = -g;
    part.slope[kTilt1] = -moment.x();
    part.slope[kTilt2] = -moment.y();
  };
  if (frame.kind == ShapeKind::line3) {
    enter(parts[0], q.x(), Vector3d::UnitX());
    enter(parts[1], q.y(), Vector3d::UnitY());
    return parts;
  }
  const double across = std::max(std::hypot(q.x(), q.y()), 1e-300);
  enter(parts[0], across - frame.radius, {q.x() / across, q.y() / across, 0});
  enter(parts[1], q.z(), Vector3d::UnitZ());
  parts[0].slope[kRadius] = -1;
  return parts;
}

Eigen::Matrix<double, 8, 8> shape_covariance(const ShapeFrame& frame, const std::vector<int>& free,
                                             const Eigen::MatrixXd& covariance) {
  Eigen::Matrix<double, 8, kParameters> slopes = Eigen::Matrix<double, 8, kParameters>::Zero();
  slopes.block<3, 3>(0, 0) = frame.axes;
  if (frame.kind == ShapeKind::line2) {
    // A turn about e2 moves the line, e1, along -e3.
    slopes.block<3, 1>(3, kTilt2) = -frame.axes.col(2);
  } else if (frame.kind != ShapeKind::sphere && frame.kind != ShapeKind::circle2) {
    slopes.block<3, 1>(3, kTilt1) = -frame.axes.col(1);
    slopes.block<3, 1>(3, kTilt2) = frame.axes.col(0);
  }
  if (has_radius(frame.kind)) slopes(6, kRadius) = 1;
  if (frame.kind == ShapeKind::cone) {
    const double sense = frame.half_angle < 0 ? -1 : 1;
    slopes(7, kHalfAngle) = sense;
    slopes.block<3, kParameters>(3, 0) *= sense;
  }
  Eigen::MatrixXd used(8, static_cast<Eigen::Index>(free.size()));
  for (std::size_t k = 0; k < free.size(); ++k) used.col(static_cast<Eigen::Index>(k)) = slopes.col(free[k]);
  return used * covariance * used.transpose();
}

}  // namespace abbe::fits
