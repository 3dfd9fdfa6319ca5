#pragma once

#include <Eigen/Core>
#include <string>

namespace abbe {

/// On which side of the engraved edge the surface has remained.
enum class EdgeSide { left, right };

struct EdgeOptions {
  EdgeSide surface = EdgeSide::left;
  double beam_tilt = 0;          ///< rad, direction of the laser in the section: from v towards u
  bool free_wall = false;        ///< the wall's direction is found from the points instead
  double surface_curvature = 0;  ///< 1/mm, of the part's surface in the section about u = 0; positive: convex
  /// Standard uncertainties of a point along u and v, mm; both 0: equal and from the residuals.
  double across_noise = 0, height_noise = 0;
};

enum class EdgeStatus {
  not_run,
  ok,
  not_finite,  ///< a coordinate is no number
  too_few_points,
  no_surface,    ///< the outer quarter of the section on the surface's side is no line
  no_edge,       ///< nowhere deeper than the scatter
  undetermined,  ///< neither the wall nor enough of the rounding is seen
  not_converged
};

/// The corner as the paper's words construct it: a circle of its own, cut with the surface. Where the circle touches
/// the surface, and that is what it is made for, the cut is anywhere: an error d of the circle across the surface moves
/// it by sqrt(2 r d), or there is none.
struct EdgeAsPrinted {
  bool circle_meets_surface = false;
  double radius = 0;    ///< mm, of the circle
  double distance = 0;  ///< P1 P2, mm
};

/// Corner of an engraved edge in a cross-section: u across the line, v out of the material, mm.
///
/// One curve for all points: the surface, a rounding that touches it, the wall along the laser that the rounding
/// touches too.
///
///     corner P2 = where surface and wall meet              on the engraved curve
///     onset  P1 = where the rounding leaves the surface    |P1 P2| = r tan(turn / 2), turn = 90 degrees + slope + tilt
///
/// Yin et al., Machines 9 (2021) 237, section 4 and Figure 13c, call |P1 P2| the contour error. It is the rounding of
/// the edge: the section of a perfectly placed edge of radius r has |P1 P2| = r, and so has one 1 mm beside its place.
/// The distance of the engraved curve from the commanded one is that of P2 from the section's origin, if that lies on
/// the commanded curve.
struct EdgeFit {
  EdgeStatus status = EdgeStatus::not_run;
  std::string reason;  ///< why the status is not ok, in words
  Eigen::Vector2d corner = Eigen::Vector2d::Zero(), onset = Eigen::Vector2d::Zero();  ///< P2, P1
  double radius = 0;                                                                  ///< mm
  double surface_slope = 0;  ///< rad, of the surface at the corner, positive upwards along u
  double wall_tilt = 0;      ///< rad, of the wall from v towards u: the beam's unless it was free
  double rounding = 0;       ///< |P1 P2|, mm
  /// Covariance of corner u, corner v (mm), slope (rad), radius (mm), tilt (rad; zero unless free).
  Eigen::Matrix<double, 5, 5> covariance = Eigen::Matrix<double, 5, 5>::Zero();
  double rounding_uncertainty = 0;  ///< standard, mm
  double noise = 0;                 ///< mm, robust scatter about the curve
  std::size_t on_surface = 0, on_rounding = 0, on_wall = 0, rejected = 0;
  double turn_seen = 0;  ///< rad, how far the points follow the rounding
  EdgeAsPrinted printed;

  double corner_uncertainty() const;  ///< standard, of u, mm
};

/// Fits that curve by weighted orthogonal distances, robustly (Tukey), to the points of one edge.
///
/// What lies deeper than three quarters of the engraving is not fitted: the bottom, and behind it the other side of a
/// groove. The bottom says one thing: the wall is not to the right of where it is seen.
/// @param points  [2, n] mm, in their order along the section from either end; the outer quarter on the surface's side
///                has to be surface
EdgeFit fit_edge(const Eigen::Ref<const Eigen::Matrix2Xd>& points, const EdgeOptions& given = {});

/// A groove: both of its edges and its middle.
struct GrooveFit {
  EdgeFit left, right;
  double middle = 0, width = 0;   ///< mm, of the two corners
  double middle_uncertainty = 0;  ///< standard, mm
  bool ok() const { return left.status == EdgeStatus::ok && right.status == EdgeStatus::ok; }
};
/// @param options  the side of the surface does not count
GrooveFit fit_groove(const Eigen::Ref<const Eigen::Matrix2Xd>& points, EdgeOptions options = {});

}  // namespace abbe
