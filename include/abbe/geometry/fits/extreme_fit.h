#pragma once

#include "abbe/geometry/fits/shape_fit.h"

namespace abbe {

/// Which extreme shape: minimum zone (Chebyshev: smallest largest distance), or the smallest around and the largest
/// within all points (circle2, sphere, cylinder only).
enum class ExtremeKind { minimum_zone, circumscribed, inscribed };

/// Minimum zone, minimum circumscribed or maximum inscribed shape.
///
/// Exact to rounding, with a proof: the contacts' multipliers are not negative and combine the gradients to zero
/// (Kolmogorov's criterion), and no other point is farther out. The least-squares shape is the start. Where the form
/// deviation is not small against the extent (above a twentieth of the smallest that counts), other starts all around
/// are tried too: the best optimum is the answer, the others are its rivals, and `ambiguous` says that one is as good.
ShapeFit extreme_fit(ShapeKind kind, ExtremeKind extreme, const FitPoints& points, const FitOptions& options = {});

}  // namespace abbe
