#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/verify/evaluations/circle_centre.h"
#include "abbe/verify/parts/test_piece_deviation.h"

namespace abbe {
namespace {

/// Places round the cone at which the circle is fitted, evenly: samples crowd where the tool is slow.
constexpr std::size_t kPlaces = 3600;

}  // namespace

Roundness cone_roundness(const ConeFrustum& frustum, const PieceDeviation& deviation, bool head) {
  Roundness result;
  const std::vector<double>& values = head ? deviation.head : deviation.foot;
  if (deviation.status != PieceTraceStatus::done || values.size() < 3) return result;
  const double full = 2 * std::numbers::pi, cosine = std::cos(frustum.half_apex_angle);
  const double nominal = frustum.base_diameter / 2 - (head ? frustum.height * std::tan(frustum.half_apex_angle) : 0.0);
  // The functional point runs round the axis evenly, so the way along its curve is the angle.
  CircularReadings all, even;
  all.kind = even.kind = CircularAngle::measured;
  for (std::size_t k = 0; k < values.size(); ++k) {
    all.angle.push_back(full * deviation.along[k] / deviation.length);
    all.radius.push_back(nominal + values[k] / cosine);
  }
  std::size_t k = 0;
  for (std::size_t n = 0; n < kPlaces; ++n) {
    const double angle = full * static_cast<double>(n) / static_cast<double>(kPlaces);
    if (angle < all.angle.front() || angle > all.angle.back()) continue;
    while (k + 2 < all.angle.size() && all.angle[k + 1] < angle) ++k;
    const double width = all.angle[k + 1] - all.angle[k];
    const double part = width > 0 ? (angle - all.angle[k]) / width : 0;
    even.angle.push_back(angle);
    even.radius.push_back((1 - part) * all.radius[k] + part * all.radius[k + 1]);
  }
  const CircleCentre circle = least_squares_circle(even);
  if (circle.status != CircleStatus::done) return result;
  result.evaluated = true;
  result.centre = circle.centre;
  result.radius_deviation = circle.radius - nominal;
  std::vector<double> radii;
  for (std::size_t n = 0; n < values.size(); ++n) radii.push_back(radius_about(all, n, circle.centre));
  const auto [lowest, highest] = std::minmax_element(radii.begin(), radii.end());
  result.roundness = *highest - *lowest;
  return result;
}

}  // namespace abbe
