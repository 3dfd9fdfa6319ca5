#pragma once

#include <span>
#include <string>
#include <vector>

#include "abbe/geometry/fits/shape_sums.h"

/// Inside of the fits: from a start to the stationary point of the sum of squares, and what all fits report.
namespace abbe::fits {

/// A frame where the sum of squares is smallest.
struct Refined {
  ShapeFrame frame;
  NormalSums sums;         ///< at the frame or one last step before it
  int iterations = 0;      ///< passes over the points
  bool converged = false;  ///< the last step was below 1e-8 of `size`, and below 1e-12 where rounding permits
};

/// Gauss-Newton with Levenberg's damping. @param size  extent of the data, mm: steps are judged against it
Refined refine(const ShapeFrame& start, const FitPoints& points, std::span<const double> weights,
               const std::vector<int>& free, double size, int most_iterations, int threads);

/// What is known of the points before any fit.
struct Survey {
  FitStatus status = FitStatus::not_run;  ///< ok, too_few_points, degenerate, bad_points
  std::string reason;
  Eigen::Vector3d centre;   ///< near the centroid, rounded: all coordinates are taken from here, mm
  Eigen::Matrix3Xd sample;  ///< up to 600 points from the centre, spread over the data
  Centroid centroid;
  Eigen::Vector3d extent;      ///< root mean square along the principal directions, largest first, mm
  Eigen::Matrix3d directions;  ///< columns: principal directions, largest extent first
  double size = 0;             ///< 3 times the largest extent, mm
};
Survey survey(ShapeKind kind, const FitPoints& points, const FitConstraints& constraints, int threads);

/// Up to `count` points from the centre, one at random (but always the same) of every stretch of the data.
Eigen::Matrix3Xd spread_sample(const FitPoints& points, const Eigen::Vector3d& centre, std::size_t count);

/// True for a line or plane that may turn: the points extend equally (to 1e-6) along and across its direction.
bool direction_is_open(ShapeKind kind, const Survey& survey, const std::vector<int>& free);

/// Enters shape, extreme distances, form and, with sigma >= 0, covariance. Changes the status to ambiguous where the
/// data do not determine the shape; without a direction there is no covariance.
/// @param normal  J'J of all steps, so that the covariance is sigma^2 (J'J)^-1
void report_fit(ShapeFit& fit, const ShapeFrame& frame, const Survey& survey, const FitPoints& points,
                const std::vector<int>& free, const Eigen::Matrix<double, kParameters, kParameters>& normal,
                double sigma, int threads);

/// @throws std::invalid_argument for constraints that are no radius, direction or angle, or that the kind does not have
void check_constraints(ShapeKind kind, const FitConstraints& constraints);

}  // namespace abbe::fits
