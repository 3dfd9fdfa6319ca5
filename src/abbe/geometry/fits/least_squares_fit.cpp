#include <algorithm>
#include <cmath>

#include "abbe/geometry/fits/shape_start.h"

namespace abbe {

using namespace fits;

ShapeFit least_squares_fit(ShapeKind kind, const FitPoints& points, const FitOptions& options) {
  ShapeFit fit;
  fit.shape.kind = kind;
  fit.points = static_cast<std::size_t>(points.cols());
  const std::vector<int> free = free_parameters(kind, options.constraints);
  fit.parameters = static_cast<int>(free.size());
  fit.degrees_of_freedom = points.cols() * rows_per_point(kind) - static_cast<long>(free.size());
  const Survey survey = fits::survey(kind, points, options.constraints, options.threads);
  fit.status = survey.status;
  fit.reason = survey.reason;
  if (!fit.ok()) return fit;

  const BestStart start = best_start(kind, survey, options.constraints);
  if (!start.found) {
    fit.status = FitStatus::degenerate;
    fit.reason = "no such shape comes near the points";
    return fit;
  }
  ShapeFrame frame = start.frame;
  // With many points most of the way is gone with some of them.
  if (points.cols() > 40000 && !is_straight(kind)) {
    const Eigen::Matrix3Xd sample = spread_sample(points, survey.centre, 8192);
    frame = refine(frame, sample, {}, free, survey.size, 100, options.threads).frame;
  }
  settle(frame, survey.centroid.mean);
  frame.centre = survey.centre;
  const Refined refined =
      refine(frame, points, {}, free, survey.size, points.cols() > 40000 ? 60 : 400, options.threads);
  fit.iterations = refined.iterations;
  fit.rms = std::sqrt(refined.sums.squares / static_cast<double>(points.cols()));
  const double dof = static_cast<double>(std::max(fit.degrees_of_freedom, 1L));
  const double sigma = options.sigma > 0             ? options.sigma
                       : fit.degrees_of_freedom == 0 ? 0
                                                     : std::sqrt(refined.sums.squares / dof);
  if (start.rival) {
    fit.status = FitStatus::ambiguous;
    fit.reason = "another shape fits the points as well";
  }
  if (has_radius(kind) && refined.frame.radius > 1e6 * survey.size) {
    fit.status = FitStatus::degenerate;
    fit.reason = "the points are on a line or plane: the radius has no bound";
  }
  report_fit(fit, refined.frame, survey, points, free, refined.sums.matrix, sigma, options.threads);
  // Where the points do not determine the shape, which is said, it is rounding whether the iteration rests.
  if (!refined.converged && fit.ok()) {
    fit.status = FitStatus::not_converged;
    fit.reason = "the iteration did not come to rest";
  }
  if (options.sigma <= 0 && fit.degrees_of_freedom == 0) fit.has_covariance = false;
  return fit;
}

const char* fit_status_name(FitStatus status) {
  switch (status) {
    case FitStatus::ok:
      return "ok";
    case FitStatus::too_few_points:
      return "too few points";
    case FitStatus::degenerate:
      return "degenerate points";
    case FitStatus::ambiguous:
      return "ambiguous";
    case FitStatus::not_converged:
      return "not converged";
    case FitStatus::no_consensus:
      return "no consensus";
    case FitStatus::bad_points:
      return "bad points";
    case FitStatus::not_run:
      break;
  }
  return "not run";
}

double ShapeFit::radius_uncertainty() const { return std::sqrt(std::max(covariance(6, 6), 0.0)); }
double ShapeFit::half_angle_uncertainty() const { return std::sqrt(std::max(covariance(7, 7), 0.0)); }

}  // namespace abbe
