#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "abbe/geometry/angle_units.h"

namespace abbe {

/// What the angle of a reading on a circular path is.
enum class CircularAngle {
  measured,  ///< polar angle of a measured point (grid encoder): angle and radius are a point of the plane
  commanded  ///< commanded direction at which a length was read (ball bar): the angle of the true point is not known
};

/// Readings of one or more circular paths about the centre of the instrument.
struct CircularReadings {
  CircularAngle kind = CircularAngle::commanded;
  std::vector<double> angle;   ///< [n] rad, from the first axis towards the second, any turn
  std::vector<double> radius;  ///< [n] mm, distance from the instrument's centre

  std::size_t count() const { return angle.size(); }
};

/// Largest angle between neighbouring readings over which a circle is still centred, rad: an arc of 200 degrees. The
/// standard centres on full circles only; see `partial` in CircularDeviation.
inline constexpr double kLargestGapForCentre = 160 * kDegree;

enum class CircleStatus {
  not_run,
  done,
  too_few_readings,  ///< fewer than three
  arc_too_short,     ///< a gap wider than kLargestGapForCentre: the centre is hardly determined
  not_converged      ///< the readings are no circle around the instrument
};

/// Centre of a path and its mean radius, seen from the instrument's centre.
struct CircleCentre {
  CircleStatus status = CircleStatus::not_run;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< mm, along the first and the second axis
  double radius = 0;                                 ///< mean radius about the centre, mm
  /// Covariance of (centre, radius) of the least-squares circle for readings of variance one.
  Eigen::Matrix3d cofactor = Eigen::Matrix3d::Zero();
};

/// Radius of reading i about a centre, mm; exact, also for a length read at a commanded angle: the point lies on the
/// ray from the centre in the commanded direction at that distance from the instrument. Below zero if there is no such
/// point.
double radius_about(const CircularReadings& readings, std::size_t i, const Eigen::Vector2d& centre);
/// Direction of reading i seen from a centre, rad in (-pi, pi].
double angle_about(const CircularReadings& readings, std::size_t i, const Eigen::Vector2d& centre);

/// The true points of readings whose path runs around that centre; unchanged if they are points already.
CircularReadings points_about(const CircularReadings& readings, const Eigen::Vector2d& centre);

/// Widest angle between neighbouring readings, rad; 2 pi for fewer than two.
double largest_gap(const CircularReadings& readings);

/// Least-squares (Gauss) circle: smallest sum of squares of radius about the centre less mean radius.
///
/// Lengths at commanded angles belong to true points that are known once the centre is: the result is the centre that
/// is the Gauss centre of its own points.
CircleCentre least_squares_circle(const CircularReadings& readings);

/// Minimum zone circles: two concentric circles of smallest separation that hold every reading.
///
/// About a centre near the right one the radii are linear in the shift, and the separation is convex and piecewise
/// linear; it is minimised by cutting planes to a certified gap below 1e-10 of the separation, then the radii are taken
/// about the new centre until it rests. `cofactor` stays zero.
/// @param readings  points; lengths become points about their least-squares centre with points_about()
CircleCentre minimum_zone_circle(const CircularReadings& readings);

}  // namespace abbe
