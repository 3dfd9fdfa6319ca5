#include "abbe/geometry/rotation.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace abbe {

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

Eigen::Matrix3d rotation_about(const Eigen::Vector3d& unit_axis, double angle) {
  const double half_sine = std::sin(0.5 * angle);
  const Eigen::Matrix3d k = skew(unit_axis);
  return Eigen::Matrix3d::Identity() + std::sin(angle) * k + 2.0 * half_sine * half_sine * k * k;
}

Eigen::Matrix3d rotation_from_error_angles(const Eigen::Vector3d& angles) {
  return rotation_about(Eigen::Vector3d::UnitZ(), angles.z()) * rotation_about(Eigen::Vector3d::UnitY(), angles.y()) *
         rotation_about(Eigen::Vector3d::UnitX(), angles.x());
}

Eigen::Vector3d error_angles_from_rotation(const Eigen::Matrix3d& r) {
  const double across = std::hypot(r(2, 1), r(2, 2));
  const double x = across > 0 ? std::atan2(r(2, 1), r(2, 2)) : 0.0;
  const double y = std::atan2(-r(2, 0), across);
  // Near EB = +-pi/2 only a sum of the others counts, and each alone has few digits: EC then has to fit EA, as the
  // second column (-sin EC, cos EC, 0) of r Rx(EA)'.
  if (across < 0.1) {
    const Eigen::Vector3d column = std::cos(x) * r.col(1) - std::sin(x) * r.col(2);
    return {x, y, std::atan2(0.0 - column.x(), column.y())};
  }
  return {x, y, std::atan2(r(1, 0), r(0, 0))};
}

Eigen::Matrix3d error_angle_axes(const Eigen::Vector3d& angles) {
  const Eigen::Matrix3d about_z = rotation_about(Eigen::Vector3d::UnitZ(), angles.z());
  const Eigen::Matrix3d about_y = rotation_about(Eigen::Vector3d::UnitY(), angles.y());
  Eigen::Matrix3d axes;
  axes << about_z * about_y.col(0), about_z.col(1), Eigen::Vector3d::UnitZ();
  return axes;
}

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& r) {
  // Through the quaternion: accurate both near zero and near pi, where the matrix formula loses digits.
  Eigen::Quaterniond q(r);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < 1e-160) return Eigen::Vector3d::Zero();
  return (2.0 * std::atan2(sine, q.w()) / sine) * q.vec();
}

Eigen::Matrix3d rotation_from_vector(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (angle < 1e-160) return Eigen::Matrix3d::Identity();
  return rotation_about(vector / angle, angle);
}

Eigen::Matrix3d rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  // Eigen's FromTwoVectors without its singular value decomposition, which takes seconds to compile.
  const Eigen::Vector3d a = from.normalized(), b = to.normalized();
  const double cosine = b.dot(a);
  if (cosine < -1 + 1e-12)
    return Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, a.unitOrthogonal())).toRotationMatrix();
  const double twice = std::sqrt((1 + cosine) * 2);
  Eigen::Quaterniond turn;
  turn.vec() = a.cross(b) * (1 / twice);
  turn.w() = twice * 0.5;
  return turn.toRotationMatrix();
}

}  // namespace abbe
