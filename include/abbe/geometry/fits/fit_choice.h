#pragma once

#include "abbe/geometry/fits/extreme_fit.h"
#include "abbe/geometry/fits/robust_fit.h"
#include "abbe/geometry/fits/shape_fit.h"

namespace abbe {

/// By what a shape is fitted.
enum class FitMethod { least_squares, minimum_zone, circumscribed, inscribed, robust };

/// A shape and the way in which it is fitted.
struct FitChoice {
  ShapeKind kind = ShapeKind::plane;
  FitMethod method = FitMethod::least_squares;
  RobustOptions robust;  ///< of the robust method
  FitOptions options;
};

/// A shape fitted to points by any method. @param points  [3, n] mm; of shapes in a plane: with z = 0
ShapeFit fit_shape(const FitChoice& choice, const FitPoints& points);

}  // namespace abbe
