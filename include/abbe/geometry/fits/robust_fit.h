#pragma once

#include <cstdint>

#include "abbe/geometry/fits/shape_fit.h"

namespace abbe {

enum class RobustKind { huber, tukey, welsch };

struct RobustOptions {
  RobustKind kind = RobustKind::tukey;
  double tuning = 0;       ///< c in units of the scale; 0: 95 % efficiency for normal noise
  std::uint64_t seed = 1;  ///< of the random subsets; same seed, same answer
};

/// Fits a shape robustly: up to about 40 % of outliers do not affect it.
///
/// Start: random subsets, least median of distances. Then iteratively reweighted least squares at a scale from the
/// median absolute distance (MAD / 0.6745), until shape and scale settle. Other shapes of as many points, and the best
/// shape of the points that are left out, are rivals; the status is `ambiguous` where one explains the points as well.
/// Source: P. J. Rousseeuw, J. Am. Stat. Assoc. 79 (1984) 871; P. J. Huber, Robust Statistics (1981).
ShapeFit robust_fit(ShapeKind kind, const FitPoints& points, const RobustOptions& robust = {},
                    const FitOptions& options = {});

}  // namespace abbe
