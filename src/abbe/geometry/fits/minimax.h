#pragma once

#include <Eigen/Core>
#include <vector>

#include "abbe/geometry/fits/shape_frame.h"

/// Inside of the fits: the smallest largest value of signed distances of a few points.
namespace abbe::fits {

/// f = sign * distance of a point from the frame.
struct SignedPoint {
  Eigen::Vector3d point;  ///< mm
  double sign = 1;
  std::size_t index = 0;  ///< of the point in the data
};

struct Minimax {
  bool converged = false;
  ShapeFrame frame;
  double value = 0;                 ///< largest f, mm
  std::vector<std::size_t> active;  ///< indices into the signed points
  std::vector<double> multipliers;  ///< of the active ones, sum 1, none negative
  double optimality = 0;            ///< |sum of multiplier * gradient|, scaled to steps of 1 mm on the surface
  Eigen::MatrixXd response;         ///< [free + 1, active] change of (steps, value) per change of an active f
};

/// Linear programs within a trust region find the active points (quadratic ones, with the curvature of the active
/// distances, where the straight steps do not end it), then Newton's method on the conditions of optimality
/// (with the curvature of the active distances) ends it: quadratic also where fewer points than parameters + 1 touch.
///
/// Source: K. Madsen, J. Inst. Maths Applics 16 (1975) 321; S. Mehrotra, SIAM J. Optim. 2 (1992) 575 (linear programs).
Minimax minimise_largest(const ShapeFrame& start, const std::vector<SignedPoint>& points, const std::vector<int>& free,
                         double size);

}  // namespace abbe::fits
