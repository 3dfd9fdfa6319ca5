#pragma once

#include <cstdint>
#include <vector>

#include "abbe/geometry/fits/robust_reweighting.h"

/// Inside of the robust fit: other shapes that the points could be.
namespace abbe::fits {

/// Another shape of the sample, compared with the answer.
struct OtherShape {
  ShapeFrame frame;
  std::vector<double> loss;
  double share = 0;        ///< of the points, those that take part
  double excess = 0;       ///< mean loss less that of the answer
  double uncertainty = 0;  ///< up to which such an excess means nothing

  bool better() const { return share >= 0.5 && excess < -uncertainty; }
  bool as_good() const { return excess <= uncertainty; }
};

/// What the other candidates lead to, and the best shape of the points that the answer leaves out, if they take a part
/// of the points that is worth naming. The mean loss of a shape is known to 0.005, and if it explains some of the
/// points left out, to three times the standard uncertainty of the difference and 0.005.
std::vector<OtherShape> other_shapes(const ShapeFrame& answer, double scale, const std::vector<ShapeFrame>& candidates,
                                     const Survey& survey, const RobustSetting& setting,
                                     const FitConstraints& constraints, std::uint64_t seed);

/// States other shapes; the fit is ambiguous if one of them explains the points as well.
void add_rivals(ShapeFit& fit, const std::vector<OtherShape>& others, const Survey& survey);

}  // namespace abbe::fits
