#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "abbe/geometry/fits/robust_fit.h"
#include "abbe/geometry/fits/shape_refine.h"

/// Inside of the robust fit: from a start to where its weights lead.
namespace abbe::fits {

/// Weight w = psi(u) / u, and the slope of psi(u) = u w, at a distance of u tuned scales.
struct Influence {
  double weight = 0, slope = 0;
};
Influence influence(RobustKind kind, double u);

/// What the reweighting needs to know.
struct RobustSetting {
  RobustKind kind = RobustKind::tukey;
  double tuning = 1;
  double median_of_normal = 1;  ///< of the distance of normal points, in standard deviations of one residual
  double least_scale = 0;       ///< that of rounding, mm
  double size = 1;              ///< mm
  double largest_scale = std::numeric_limits<double>::infinity();  ///< mm
  std::size_t met = 0;  ///< points through which the shape can always be laid
  std::vector<int> free;
};

struct Reweighted {
  ShapeFrame frame;
  double scale = 0;  ///< mm
  bool rested = false;
  int iterations = 0;
};

/// Iteratively reweighted least squares until shape and scale rest.
/// @param most  steps
Reweighted reweigh(const ShapeFrame& start, const FitPoints& points, const RobustSetting& setting, int most,
                   int threads);

}  // namespace abbe::fits
