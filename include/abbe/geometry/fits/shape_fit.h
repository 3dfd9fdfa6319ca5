#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "abbe/geometry/fits/shapes.h"

namespace abbe {

/// What a fit can say about itself. Only `ok` is an answer; with the others the shape is what was reached and counts
/// for nothing.
enum class FitStatus {
  not_run,
  ok,
  too_few_points,  ///< fewer than the shape has parameters (after the constraints)
  degenerate,      ///< coincident, collinear or coplanar points where the shape needs more
  ambiguous,       ///< the data do not determine the parameters, or different shapes fit equally well
  not_converged,   ///< the iteration did not reach a stationary point
  no_consensus,    ///< robust fit: no shape explains half of the points
  bad_points       ///< coordinates that are not finite
};
const char* fit_status_name(FitStatus status);

/// What is known beforehand.
struct FitConstraints {
  std::optional<double> radius;              ///< mm; circles, sphere, cylinder
  std::optional<Eigen::Vector3d> direction;  ///< of lines, plane, circle3, cylinder, cone; need not be a unit vector
  std::optional<double> half_angle;          ///< rad; cone
};

struct FitOptions {
  FitConstraints constraints;
  double sigma = 0;  ///< standard uncertainty of a point across the shape, mm; 0: from the residuals (least squares,
                     ///< robust) or no covariance (minimum zone)
  int threads = 0;   ///< as for_each_block(); does not change the result
};

/// Another shape that is the best one among its neighbours.
struct ShapeRival {
  Shape shape;
  double form = 0;   ///< minimum zone: form deviation, mm
  double share = 0;  ///< robust: of the points, those that take part
};

/// A fitted shape with what is needed to judge it.
struct ShapeFit {
  FitStatus status = FitStatus::not_run;
  std::string reason;  ///< why the status is not ok, in words
  Shape shape;

  std::size_t points = 0;
  int parameters = 0;  ///< free ones
  long degrees_of_freedom = 0;
  double rms = 0;       ///< root mean square distance, mm (robust fit: weighted)
  double smallest = 0;  ///< extreme distances, mm
  double largest = 0;
  std::size_t smallest_at = 0, largest_at = 0;  ///< indices of the points there
  /// Form deviation: largest less smallest distance (peak to valley); for line3 and circle3 the diameter of the tube
  /// about the line that holds every point. mm
  double form = 0;
  double sigma = 0;  ///< standard deviation of a point that the covariance is made with, mm
  int iterations = 0;

  /// Covariance of (point, direction, radius, half_angle), mm and rad (direction: per unit vector), in the frame of the
  /// points; [8, 8], singular across what does not matter (the point along an axis, the length of the direction).
  Eigen::Matrix<double, 8, 8> covariance = Eigen::Matrix<double, 8, 8>::Zero();
  bool has_covariance = false;

  /// Minimum zone and circumscribed and inscribed: the points that determine the answer, with multipliers (sum 1).
  std::vector<std::size_t> contacts;
  std::vector<double> multipliers;
  double optimality = 0;  ///< length of the convex combination of the contacts' gradients: 0 at the optimum

  /// Minimum zone and the like, and robust: others that were found, best first; `ambiguous` where one is as good.
  std::vector<ShapeRival> rivals;

  std::vector<double> weights;  ///< robust: [points] last weights
  std::size_t rejected = 0;     ///< robust: points with weight below 1e-3

  bool ok() const { return status == FitStatus::ok; }
  double radius_uncertainty() const;      ///< standard, mm
  double half_angle_uncertainty() const;  ///< standard, rad
  /// Standard uncertainty of the direction: of its most uncertain tilt, rad.
  double direction_uncertainty() const;
  /// Standard uncertainty of the point in its most uncertain direction, mm.
  double point_uncertainty() const;
};

/// Points of a fit: [3, n] mm; shapes of the plane have z = 0.
using FitPoints = Eigen::Ref<const Eigen::Matrix3Xd>;

/// Least-squares (Gauss) shape: the smallest sum of squared orthogonal distances.
///
/// Finds its own start. Gauss-Newton with Levenberg's damping in a frame that moves with the shape, sums over blocks of
/// points on several threads in a fixed order; coordinates far from the origin lose nothing.
/// Source: C. M. Shakarji, J. Res. NIST 103 (1998) 633; A. B. Forbes, NPL Report DITC 140/89.
ShapeFit least_squares_fit(ShapeKind kind, const FitPoints& points, const FitOptions& options = {});

}  // namespace abbe
