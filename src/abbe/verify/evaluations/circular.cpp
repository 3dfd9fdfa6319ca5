#include "abbe/verify/evaluations/circular.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace abbe {
namespace {

/// A full circle of a test has readings at least this close, rad.
constexpr double kLargestGapOfFullCircle = std::numbers::pi / 6;

Eigen::Vector3d direction_with(double angle, double last) { return {std::cos(angle), std::sin(angle), last}; }

/// Standard uncertainties for readings of standard uncertainty u and a common one of the length; see
/// docs/evaluate-geometry.md.
void add_uncertainties(const CircleCentre& centre, const CircularOptions& options, CircularDeviation& result) {
  const double reading = options.reading_uncertainty, length = options.length_uncertainty;
  const Eigen::Matrix3d& cofactor = centre.cofactor;  // zero unless the centre comes from least squares
  const Eigen::Vector3d largest = direction_with(result.angle[result.largest_at], 1);
  const Eigen::Vector3d smallest = direction_with(result.angle[result.smallest_at], 1);
  const Eigen::Vector3d apart = largest - smallest;
  const double of_difference = std::max(0.0, 2 - apart.dot(cofactor * apart));
  result.circular_uncertainty = reading * std::sqrt(of_difference);
  const auto radial = [&](const Eigen::Vector3d& row) {
    const Eigen::Vector3d shift(row[0], row[1], 0);
    const double variance = std::max(0.0, 1 - 2 * shift.dot(cofactor * row) + shift.dot(cofactor * shift));
    return std::hypot(reading * std::sqrt(variance), length);
  };
  result.radial_largest_uncertainty = radial(largest);
  result.radial_smallest_uncertainty = radial(smallest);
}

CircularDeviation deviation(CircularReadings readings, const CircularOptions& options) {
  CircularDeviation result;
  if (readings.count() == 0) return result;
  CircleCentre centre;
  if (options.centre == CircularCentre::instrument) {
    centre.status = CircleStatus::done;
    for (const double radius : readings.radius) centre.radius += radius / static_cast<double>(readings.count());
  } else {
    centre = least_squares_circle(readings);
    // The machine's circle runs about its own mean centre: from here on the readings are points.
    if (centre.status == CircleStatus::done) readings = points_about(readings, centre.centre);
    if (options.centre == CircularCentre::minimum_zone && centre.status == CircleStatus::done) {
      centre = minimum_zone_circle(readings);
    }
  }
  result.status = centre.status;
  result.partial = largest_gap(readings) > kLargestGapOfFullCircle;
  if (centre.status != CircleStatus::done) return result;
  result.centre = centre.centre;
  result.mean_radius = centre.radius;
  for (std::size_t i = 0; i < readings.count(); ++i) {
    result.angle.push_back(angle_about(readings, i, centre.centre));
    result.deviations.push_back(radius_about(readings, i, centre.centre) - options.nominal_radius);
  }
  const auto [smallest, largest] = std::minmax_element(result.deviations.begin(), result.deviations.end());
  result.smallest_at = static_cast<std::size_t>(smallest - result.deviations.begin());
  result.largest_at = static_cast<std::size_t>(largest - result.deviations.begin());
  result.radial_smallest = *smallest;
  result.radial_largest = *largest;
  result.circular = *largest - *smallest;
  add_uncertainties(centre, options, result);
  return result;
}

}  // namespace

CircularResult circular_deviations(const std::array<CircularReadings, 2>& paths, const CircularOptions& options) {
  assert(options.nominal_radius > 0);
  CircularResult result;
  for (std::size_t k = 0; k < 2; ++k) {
    assert(paths[k].angle.size() == paths[k].radius.size());
    result.paths[k] = deviation(paths[k], options);
  }
  if (paths[0].count() == 0 || paths[1].count() == 0) return result;
  assert(paths[0].kind == paths[1].kind);
  CircularReadings both = paths[0];
  both.angle.insert(both.angle.end(), paths[1].angle.begin(), paths[1].angle.end());
  both.radius.insert(both.radius.end(), paths[1].radius.begin(), paths[1].radius.end());
  // An arc that is too short is not mended by another arc elsewhere.
  for (const CircularDeviation& path : result.paths) {
    result.both.status = path.status;
    if (path.status != CircleStatus::done) return result;
  }
  result.both = deviation(both, options);
  result.both.partial = result.paths[0].partial || result.paths[1].partial;
  result.has_mean = true;
  double variance = options.length_uncertainty * options.length_uncertainty;
  for (std::size_t k = 0; k < 2; ++k) {
    // D is defined by the least-squares circles, whatever centre the other values are taken about.
    const CircleCentre gauss = least_squares_circle(paths[k]);
    if (gauss.status != CircleStatus::done) result.has_mean = false;
    result.mean += (gauss.radius - options.nominal_radius) / 2;
    variance += options.reading_uncertainty * options.reading_uncertainty * gauss.cofactor(2, 2) / 4;
  }
  if (!result.has_mean) result.mean = 0;
  result.mean_uncertainty = result.has_mean ? std::sqrt(variance) : 0;
  return result;
}

}  // namespace abbe
