#include "abbe/geometry/fits/shapes.h"

#include <Eigen/Geometry>
#include <cmath>

namespace abbe {

using Eigen::Vector3d;

const char* shape_name(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::line2:
      return "line2";
    case ShapeKind::line3:
      return "line3";
    case ShapeKind::plane:
      return "plane";
    case ShapeKind::circle2:
      return "circle2";
    case ShapeKind::circle3:
      return "circle3";
    case ShapeKind::sphere:
      return "sphere";
    case ShapeKind::cylinder:
      return "cylinder";
    case ShapeKind::cone:
      break;
  }
  return "cone";
}

Vector3d Shape::apex() const { return point - radius / std::tan(half_angle) * direction; }

double distance(const Shape& shape, const Vector3d& point) {
  const Vector3d q = point - shape.point;
  const double along = q.dot(shape.direction);
  const double across = (q - along * shape.direction).norm();
  switch (shape.kind) {
    case ShapeKind::line2:
      return shape.direction.x() * q.y() - shape.direction.y() * q.x();
    case ShapeKind::line3:
      return across;
    case ShapeKind::plane:
      return along;
    case ShapeKind::circle2:
    case ShapeKind::cylinder:
      return across - shape.radius;
    case ShapeKind::circle3:
      return std::hypot(along, across - shape.radius);
    case ShapeKind::sphere:
      return q.norm() - shape.radius;
    case ShapeKind::cone:
      break;
  }
  return (across - shape.radius) * std::cos(shape.half_angle) - along * std::sin(shape.half_angle);
}

}  // namespace abbe
