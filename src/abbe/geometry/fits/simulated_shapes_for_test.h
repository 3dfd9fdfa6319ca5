#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "abbe/geometry/fits/numbers_for_test.h"
#include "abbe/geometry/fits/shapes.h"

/// Small sets of measured points of every shape, as a coordinate measuring machine gives them.
namespace abbe::test {

/// A shape, a few points measured on it, and how well they determine it.
struct SimulatedSet {
  Shape truth;
  Eigen::Matrix3Xd points;
  double size = 1;   ///< largest extent of the part, mm
  double noise = 0;  ///< standard deviation of a point across the shape, mm
  double far = 0;    ///< distance of the part from the origin, mm
  /// To first order, from the true shape and the noise: largest standard uncertainty of the angles (rad), of the radius
  /// against the radius and of the place against the size.
  double uncertainty = 0;
  Eigen::MatrixXd slopes;  ///< [residuals, parameters] of the distances at the truth, in units of the size

  std::size_t count() const { return static_cast<std::size_t>(points.cols()); }
};

/// @param closed  all around: arcs of 360 degrees
SimulatedSet simulated_set(ShapeKind kind, Numbers& numbers, bool closed = false);

}  // namespace abbe::test
