#pragma once

// Internal to instruments: rotation of a vector by a rotation vector, for any scalar.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "abbe/geometry/dual.h"

namespace abbe {

/// exp(-w) v with a rotation vector w, rad; Rodrigues' formula.
template <typename S>
Eigen::Matrix<S, 3, 1> turned_back(const Eigen::Matrix<S, 3, 1>& w, const Eigen::Matrix<S, 3, 1>& v) {
  using std::cos, std::sin, std::sqrt;
  // Below this square of an angle the series is exact to rounding.
  constexpr double kSmallTurn = 1e-6;
  const S square = w.dot(w);
  S first = S(1) - square / S(6), second = S(0.5) - square / S(24);
  if (value_of(square) > kSmallTurn) {
    const S angle = sqrt(square);
    first = sin(angle) / angle;
    second = (S(1) - cos(angle)) / square;
  }
  const Eigen::Matrix<S, 3, 1> across = w.cross(v);
  return v - first * across + second * w.cross(across);
}

}  // namespace abbe
