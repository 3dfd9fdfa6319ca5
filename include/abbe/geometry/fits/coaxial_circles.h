#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "abbe/geometry/fits/shape_fit.h"

namespace abbe {

/// What is known beforehand of circles about one axis.
struct CoaxialOptions {
  std::optional<Eigen::Vector3d> direction;  ///< of the axis; need not be a unit vector
  std::vector<double> radii;                 ///< mm, one per circle, or empty: free
  double sigma = 0;  ///< standard uncertainty of a point across its circle, mm; 0: from residuals
};

/// Circles in planes across one common axis: turned steps, a mark of a part on a rotary axis at several heights.
struct CoaxialCircles {
  FitStatus status = FitStatus::not_run;
  std::string reason;           ///< why the status is not ok, in words
  Eigen::Vector3d point;        ///< of the axis, mean of the centres, mm
  Eigen::Vector3d direction;    ///< unit; its largest component is positive
  std::vector<double> heights;  ///< of the centres from `point` along the direction, mm
  std::vector<double> radii;    ///< mm

  std::size_t points = 0;
  long degrees_of_freedom = 0;
  double sigma = 0;          ///< standard deviation of a residual, mm
  double rms = 0;            ///< root mean square distance of a point from its circle, mm
  std::vector<double> form;  ///< per circle: diameter of the tube about it that holds its points, mm
  int iterations = 0;

  /// Of (point, direction, heights, radii): [6 + 2 m, 6 + 2 m] mm and rad, in the frame of the points. The point counts
  /// across the axis only; the heights from that point held still.
  Eigen::MatrixXd covariance;
  bool has_covariance = false;

  bool ok() const { return status == FitStatus::ok; }
  Eigen::Vector3d centre(std::size_t circle) const { return point + heights[circle] * direction; }
};

/// Least-squares circles about one axis, all points at once: the smallest sum of squared distances of the points from
/// their circles. Four parameters of the axis, height and radius of each circle.
///
/// Two circles suffice for the axis, also where each alone is a short arc; one is circle3.
/// @param circles  [m] points of each circle, [3, n_i] mm
/// @throws std::invalid_argument for a direction that is none or radii that are not positive or not one per circle
CoaxialCircles coaxial_circles_fit(std::span<const Eigen::Matrix3Xd> circles, const CoaxialOptions& options = {});

}  // namespace abbe
