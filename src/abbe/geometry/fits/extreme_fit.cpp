#include "abbe/geometry/fits/extreme_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>

#include "abbe/geometry/fits/extreme_starts.h"
#include "abbe/geometry/fits/minimax.h"

namespace abbe {

using namespace fits;

namespace {

/// Exchange of working points about one start.
class Exchange {
 public:
  Exchange(ExtremeKind extreme, const FitPoints& points, const std::vector<int>& free, double size, int threads)
      : points_(points),
        free_(free),
        size_(size),
        threads_(threads),
        extreme_(extreme),
        d_(static_cast<std::size_t>(points.cols())),
        order_(d_.size()) {}

  struct Reached {
    bool converged = false;
    std::string reason;
    ShapeFrame frame;
    Minimax answer;
    std::vector<SignedPoint> working;
    int exchanges = 0;
  };
  Reached from(const ShapeFrame& start) {
    const bool above = extreme_ != ExtremeKind::inscribed;
    const bool below = extreme_ == ExtremeKind::inscribed ||
                       (extreme_ == ExtremeKind::minimum_zone && rows_per_point(start.kind) == 1);
    const double tolerance = 1e-12 * size_;
    working_.clear();
    taken_.clear();
    Reached reached;
    reached.frame = start;
    const double anything = -std::numeric_limits<double>::infinity();
    distances(start, points_, d_, threads_);
    if (above) add_farthest(true, 40, anything);
    if (below) add_farthest(false, 40, anything);
    reached.reason = "the exchange of points did not come to rest";
    while (reached.exchanges < 200) {
      ++reached.exchanges;
      reached.answer = minimise_largest(reached.frame, working_, free_, size_);
      if (!reached.answer.converged) {
        reached.reason = extreme_ == ExtremeKind::inscribed
                             ? "no largest shape within the points was reached: do they surround it?"
                             : "no point that meets the conditions of the optimum was reached";
        return reached;
      }
      reached.frame = reached.answer.frame;
      distances(reached.frame, points_, d_, threads_);
      bool more = false;
      if (above) more = add_farthest(true, 10, reached.answer.value + tolerance) || more;
      if (below) more = add_farthest(false, 10, reached.answer.value + tolerance) || more;
      if (more) continue;
      reached.converged = true;
      reached.reason.clear();
      break;
    }
    reached.working = working_;
    return reached;
  }

 private:
  /// The points farthest out on a side that are not yet among the working ones.
  bool add_farthest(bool positive, std::size_t count, double beyond) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    const double sign = positive ? 1 : -1;
    count = std::min(count, order_.size());
    std::partial_sort(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(count), order_.end(),
                      [&](std::size_t a, std::size_t b) { return sign * d_[a] > sign * d_[b]; });
    bool added = false;
    for (std::size_t k = 0; k < count && sign * d_[order_[k]] > beyond; ++k) {
      if (!taken_.emplace(order_[k], positive).second) continue;
      working_.push_back({points_.col(static_cast<Eigen::Index>(order_[k])), sign, order_[k]});
      added = true;
    }
    return added;
  }

  const FitPoints& points_;
  const std::vector<int>& free_;
  double size_;
  int threads_;
  ExtremeKind extreme_;
  std::vector<double> d_;
  std::vector<std::size_t> order_;
  std::vector<SignedPoint> working_;
  std::set<std::pair<std::size_t, bool>> taken_;
};

/// The optima to which other starts lead, the best few of those that differ from each other and from the first one.
std::vector<Exchange::Reached> other_optima(ExtremeKind extreme, const ShapeFrame& least_squares,
                                            const Exchange::Reached& first, const FitPoints& points,
                                            const std::vector<int>& free, const Survey& survey,
                                            const FitOptions& options) {
  constexpr std::size_t kMost = 4;
  constexpr double kHopeless = 1.5;  // times the best value on the sample
  ShapeFrame centred = least_squares;
  centred.centre.setZero();
  const auto better = [](const Exchange::Reached& a, const Exchange::Reached& b) {
    return a.answer.value < b.answer.value;
  };
  const auto is_new = [&](const std::vector<Exchange::Reached>& known, const ShapeFrame& frame) {
    return std::none_of(known.begin(), known.end(), [&](const Exchange::Reached& other) {
      return other.converged && !differ(other.frame, frame, survey);
    });
  };
  // Roughly with some of the points.
  const FitPoints sample(survey.sample);
  Exchange rough(extreme, sample, free, survey.size, 1);
  std::vector<Exchange::Reached> found;
  for (const ShapeFrame& start : extreme_starts(extreme, centred, survey, options.constraints)) {
    Exchange::Reached reached = rough.from(start);
    if (reached.converged && is_new(found, reached.frame)) found.push_back(std::move(reached));
  }
  std::stable_sort(found.begin(), found.end(), better);
  std::vector<Exchange::Reached> optima{first};
  Exchange exact(extreme, points, free, survey.size, options.threads);
  const double best = found.empty() ? 0 : found.front().answer.value;
  for (const Exchange::Reached& start : found) {
    // Values of inscribed shapes are negative: minus the radius.
    if (start.answer.value > best + (kHopeless - 1) * std::abs(best) || optima.size() > kMost) break;
    ShapeFrame frame = start.frame;
    frame.centre = survey.centre;
    if (frame.kind == ShapeKind::cylinder || frame.kind == ShapeKind::cone) settle(frame, survey.centroid.mean);
    Exchange::Reached reached = exact.from(frame);
    if (reached.converged && is_new(optima, reached.frame)) optima.push_back(std::move(reached));
  }
  std::stable_sort(optima.begin(), optima.end(), [](const Exchange::Reached& a, const Exchange::Reached& b) {
    return a.converged != b.converged ? a.converged : a.answer.value < b.answer.value;
  });
  return optima;
}

}  // namespace

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

  std::vector<Exchange::Reached> optima{Exchange(extreme, points, free, survey.size, options.threads).from(frame)};
  if (may_have_rivals(kind, survey, fit.form)) {
    optima = other_optima(extreme, frame, optima.front(), points, free, survey, options);
  }
  const Exchange::Reached& best = optima.front();
  fit.iterations += best.exchanges;
  fit.status = best.converged ? FitStatus::ok : FitStatus::not_converged;
  fit.reason = best.reason;
  if (!best.converged) return fit;
  for (std::size_t k = 1; k < optima.size(); ++k) {
    const Exchange::Reached& other = optima[k];
    if (!other.converged) continue;
    ShapeRival rival;
    ShapeFrame at = other.frame;
    if (zone) {
      rival.form = 2 * other.answer.value;
    } else {
      at.radius = std::abs(other.answer.value);
    }
    rival.shape = shape_of(at, survey.centroid.mean);
    fit.rivals.push_back(rival);
    if (other.answer.value - best.answer.value <= 1e-5 * std::abs(best.answer.value) + 1e-10 * survey.size) {
      fit.status = FitStatus::ambiguous;
      fit.reason = "another shape is as good";
    }
  }
  const Minimax& answer = best.answer;
  frame = best.frame;
  if (!zone) {
    frame.radius = extreme == ExtremeKind::circumscribed ? answer.value : -answer.value;
    free.push_back(kRadius);
  }
  for (std::size_t k = 0; k < answer.active.size(); ++k) {
    fit.contacts.push_back(best.working[answer.active[k]].index);
    fit.multipliers.push_back(answer.multipliers[k]);
  }
  fit.optimality = answer.optimality;
  double squares = 0;
  std::vector<double> d(fit.points);
  distances(frame, points, d, options.threads);
  for (const double x : d) squares += x * x;
  fit.rms = std::sqrt(squares / static_cast<double>(fit.points));
  report_fit(fit, frame, survey, points, free, Eigen::Matrix<double, kParameters, kParameters>::Zero(), -1,
             options.threads);
  fit.sigma = options.sigma;
  if (options.sigma > 0 && fit.ok()) {
    const auto p = answer.response.rows() - 1;
    Eigen::MatrixXd response = answer.response.topRows(zone ? p : p + 1);
    if (extreme == ExtremeKind::inscribed) response.row(p) *= -1;
    fit.covariance = shape_covariance(frame, free, options.sigma * options.sigma * response * response.transpose());
    fit.has_covariance = true;
  }
  return fit;
}

}  // namespace abbe
