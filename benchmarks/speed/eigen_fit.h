#pragma once

#include "abbe/geometry/fits/shapes.h"

namespace abbe::benchmarks {

struct EigenFit {
  Shape shape;
  double squares = 0;  ///< sum of squared distances, mm^2
  int iterations = 0;
};

/// Least-squares fit as a textbook writes it: Gauss-Newton from a given start, the whole Jacobian as a dense matrix,
/// normal equations with Eigen, coordinates from the centroid, no blocks, one thread.
EigenFit eigen_fit(const Shape& start, const Eigen::Matrix3Xd& points);

}  // namespace abbe::benchmarks
