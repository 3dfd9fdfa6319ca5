#pragma once

#include <Eigen/Geometry>
#include <cmath>

namespace abbe {

/// A nominal direction of a set-up and the two directions in which it may be tilted.
///
/// `first` is the axis of the frame that follows the nominal direction's largest component in the order X Y Z X, made
/// perpendicular to it; `second` = direction x first. So for Z: first X, second Y; for -Z: first X, second -Y.
struct DirectionFrame {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit
  Eigen::Vector3d first = Eigen::Vector3d::UnitX();      ///< unit
  Eigen::Vector3d second = Eigen::Vector3d::UnitY();     ///< unit

  /// @param nominal  any length but zero
  static DirectionFrame of(const Eigen::Vector3d& nominal) {
    DirectionFrame frame;
    frame.direction = nominal.normalized();
    Eigen::Index largest = 0;
    frame.direction.cwiseAbs().maxCoeff(&largest);
    const Eigen::Vector3d next = Eigen::Vector3d::Unit((largest + 1) % 3);
    frame.first = (next - next.dot(frame.direction) * frame.direction).normalized();
    frame.second = frame.direction.cross(frame.first);
    return frame;
  }

  /// (direction + a first + b second) / |...|: a and b are tangents of the tilts towards first and second, for small
  /// tilts the angles in rad.
  template <typename S>
  Eigen::Matrix<S, 3, 1> tilted(const S& a, const S& b) const {
    using std::sqrt;
    const S length = sqrt(a * a + b * b + S(1.0));
    Eigen::Matrix<S, 3, 1> result;
    for (int i = 0; i < 3; ++i) result[i] = (a * S(first[i]) + b * S(second[i]) + S(direction[i])) / length;
    return result;
  }
};

/// Rz(c) Ry(b) Rx(a) of angles a, b, c about X, Y, Z, rad.
template <typename S>
Eigen::Matrix<S, 3, 3> rotation_zyx(const S& a, const S& b, const S& c) {
  using std::cos;
  using std::sin;
  const S sa = sin(a), ca = cos(a), sb = sin(b), cb = cos(b), sc = sin(c), cc = cos(c);
  Eigen::Matrix<S, 3, 3> r;
  r(0, 0) = cc * cb;
  r(0, 1) = cc * sb * sa - sc * ca;
  r(0, 2) = cc * sb * ca + sc * sa;
  r(1, 0) = sc * cb;
  r(1, 1) = sc * sb * sa + cc * ca;
  r(1, 2) = sc * sb * ca - cc * sa;
  r(2, 0) = -sb;
  r(2, 1) = cb * sa;
  r(2, 2) = cb * ca;
  return r;
}

}  // namespace abbe
