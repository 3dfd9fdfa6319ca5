#include "abbe/geometry/extreme_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>

#include "abbe/geometry/minimax.h"
#include "abbe/geometry/shape_start.h"

namespace abbe {

using namespace fits;

ShapeFit extreme_fit(ShapeKind kind, ExtremeKind extreme, const FitPoints& points, const FitOptions& options) {
  const bool zone = extreme == ExtremeKind::minimum_zone;
  const bool round = kind == ShapeKind::circle2 || kind == ShapeKind::sphere || kind == ShapeKind::cylinder;
  if (!zone && (!round || options.constraints.radius)) {
    throw std::invalid_argument("circumscribed and inscribed are circle2, sphere and cylinder with a free radius");
  }
  ShapeFit fit = least_squares_fit(kind, points, options);
  fit.has_covariance = false;
  fit.covariance.setZero();
  if (!fit.ok()) return fit;
  const double reading = 4e-16 * points.col(0).cwiseAbs().maxCoeff();
  const Survey survey = fits::survey(kind, points, options.constraints, options.threads);
  // Points on the shape to rounding: nothing is left to make smaller.
  if (zone && fit.form <= 1e-12 * survey.size + reading) return fit;
  ShapeFrame frame;
  frame.kind = kind;
  frame.centre = survey.centre;
  frame.origin = fit.shape.point - survey.centre;
  if (kind == ShapeKind::line2) {
    frame.axes = axes_of_line2(fit.shape.direction);
  } else if (kind != ShapeKind::sphere) {
    frame.axes = axes_along(fit.shape.direction);
  }
  frame.radius = zone ? fit.shape.radius : 0;
  frame.half_angle = fit.shape.half_angle;
  std::vector<int> free = free_parameters(kind, options.constraints);
  if (!zone) std::erase(free, static_cast<int>(kRadius));

  const bool above = extreme != ExtremeKind::inscribed;
  const bool below = extreme == ExtremeKind::inscribed || (zone && rows_per_point(kind) == 1);
  const double tolerance = 1e-12 * survey.size;
  std::vector<SignedPoint> working;
  std::set<std::pair<std::size_t, bool>> taken;
  std::vector<double> d(fit.points);
  std::vector<std::size_t> order(fit.points);
  // The points farthest out on each side that are not yet among the working ones.
  const auto add_farthest = [&](bool positive, std::size_t count, double beyond) {
    std::iota(order.begin(), order.end(), std::size_t{0});
    const double sign = positive ? 1 : -1;
    count = std::min(count, order.size());
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
                      [&](std::size_t a, std::size_t b) { return sign * d[a] > sign * d[b]; });
    bool added = false;
    for (std::size_t k = 0; k < count && sign * d[order[k]] > beyond; ++k) {
      if (!taken.emplace(order[k], positive).second) continue;
      working.push_back({points.col(static_cast<Eigen::Index>(order[k])), sign, order[k]});
      added = true;
    }
    return added;
  };
  const double anything = -std::numeric_limits<double>::infinity();
  distances(frame, points, d, options.threads);
  if (above) add_farthest(true, 40, anything);
  if (below) add_farthest(false, 40, anything);
  Minimax answer;
  fit.status = FitStatus::not_converged;
  fit.reason = "the exchange of points did not come to rest";
  for (int exchange = 0; exchange < 200; ++exchange) {
    ++fit.iterations;
    answer = minimise_largest(frame, working, free, survey.size);
    if (!answer.converged) {
      fit.reason = extreme == ExtremeKind::inscribed
                       ? "no largest shape within the points was reached: do they surround it?"
                       : "no place with the conditions of the optimum was reached";
      return fit;
    }
    frame = answer.frame;
    distances(frame, points, d, options.threads);
    bool more = false;
    if (above) more = add_farthest(true, 10, answer.value + tolerance) || more;
    if (below) more = add_farthest(false, 10, answer.value + tolerance) || more;
    if (more) continue;
    fit.status = FitStatus::ok;
    fit.reason.clear();
    break;
  }
  if (!zone) {
    frame.radius = above ? answer.value : -answer.value;
    free.push_back(kRadius);
  }
  for (std::size_t k = 0; k < answer.active.size(); ++k) {
    fit.contacts.push_back(working[answer.active[k]].index);
    fit.multipliers.push_back(answer.multipliers[k]);
  }
  fit.optimality = answer.optimality;
  double squares = 0;
  distances(frame, points, d, options.threads);
  for (const double x : d) squares += x * x;
  fit.rms = std::sqrt(squares / static_cast<double>(fit.points));
  report_fit(fit, frame, survey, points, free, Eigen::Matrix<double, kParameters, kParameters>::Zero(), -1,
             options.threads);
  fit.sigma = options.sigma;
  if (options.sigma > 0 && fit.ok()) {
    const auto p = answer.response.rows() - 1;
    Eigen::MatrixXd response = answer.response.topRows(zone ? p : p + 1);
    if (!zone && !above) response.row(p) *= -1;
    fit.covariance = shape_covariance(frame, free, options.sigma * options.sigma * response * response.transpose());
    fit.has_covariance = true;
  }
  return fit;
}

}  // namespace abbe
