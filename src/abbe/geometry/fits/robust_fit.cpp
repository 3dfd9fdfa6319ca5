#include "abbe/geometry/fits/robust_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "abbe/geometry/fits/least_median.h"
#include "abbe/geometry/fits/robust_rivals.h"

namespace abbe {
namespace {

using namespace fits;

double default_tuning(RobustKind kind) {
  return kind == RobustKind::huber ? 1.345 : kind == RobustKind::tukey ? 4.685 : 2.985;
}

}  // namespace

ShapeFit robust_fit(ShapeKind kind, const FitPoints& points, const RobustOptions& robust, const FitOptions& options) {
  ShapeFit fit;
  fit.shape.kind = kind;
  fit.points = static_cast<std::size_t>(points.cols());
  const std::vector<int> free = free_parameters(kind, options.constraints);
  fit.parameters = static_cast<int>(free.size());
  const int rows = rows_per_point(kind);
  fit.degrees_of_freedom = points.cols() * rows - static_cast<long>(free.size());
  const Survey survey = fits::survey(kind, points, options.constraints, options.threads);
  fit.status = survey.status;
  fit.reason = survey.reason;
  if (!fit.ok()) return fit;
  std::vector<ShapeFrame> candidates = least_median_shapes(kind, survey, options.constraints, robust.seed);
  if (candidates.empty()) {
    fit.status = FitStatus::no_consensus;
    fit.reason = "no such shape comes near half of the points";
    return fit;
  }
  ShapeFrame frame = candidates.front();
  settle(frame, survey.centroid.mean);
  frame.centre = survey.centre;

  RobustSetting setting;
  setting.kind = robust.kind;
  setting.tuning = robust.tuning > 0 ? robust.tuning : default_tuning(robust.kind);
  setting.median_of_normal = rows == 2 ? 1.1774100225154747 : 0.6744897501960817;
  setting.least_scale = 1e-14 * (survey.size + survey.centre.cwiseAbs().maxCoeff());
  setting.size = survey.size;
  setting.free = free;
  setting.met = points_met(kind, free.size());
  // The smallest median rests on one distance. Of few points another shape may leave a smaller loss at that scale, and
  // then it is the answer; it is compared with the first one at its own scale.
  constexpr int kMostSteps = 1000, kMostAnswers = 3;
  Reweighted rest;
  std::vector<OtherShape> others;
  for (int answer = 0; answer < kMostAnswers; ++answer) {
    rest = reweigh(frame, points, setting, kMostSteps, options.threads);
    fit.iterations += rest.iterations;
    frame = rest.frame;
    others = other_shapes(frame, rest.scale, candidates, survey, setting, options.constraints, robust.seed);
    const auto best = std::min_element(others.begin(), others.end(),
                                       [](const OtherShape& a, const OtherShape& b) { return a.excess < b.excess; });
    if (best == others.end() || !best->better() || answer + 1 == kMostAnswers) break;
    candidates.push_back(frame);
    candidates.back().centre.setZero();
    frame = best->frame;
    settle(frame, survey.centroid.mean);
  }
  const double scale = rest.scale, tuning = setting.tuning;

  std::vector<double> d(fit.points);
  fit.weights.resize(fit.points);
  distances(frame, points, d, options.threads);
  std::vector<double> used(fit.points);
  double psi_squares = 0, psi_slopes = 0, squares = 0, weight = 0, count = 0;
  double smallest = std::numeric_limits<double>::infinity(), largest = -smallest;
  std::size_t smallest_at = 0, largest_at = 0;
  for (std::size_t i = 0; i < d.size(); ++i) {
    const Influence f = influence(robust.kind, std::abs(d[i]) / (tuning * scale));
    fit.weights[i] = f.weight;
    used[i] = f.weight > 1e-3 ? 1 : 0;
    squares += f.weight * d[i] * d[i];
    weight += f.weight;
    if (used[i] == 0) continue;
    ++count;
    psi_squares += std::pow(f.weight * d[i], 2);
    // Of two residuals with one weight only that along the distance sees the weight change.
    psi_slopes += rows == 2 ? (f.weight + f.slope) / 2 : f.slope;
    if (d[i] < smallest) smallest = d[i], smallest_at = i;
    if (d[i] > largest) largest = d[i], largest_at = i;
  }
  fit.rejected = fit.points - static_cast<std::size_t>(count);
  fit.rms = weight > 0 ? std::sqrt(squares / weight) : 0;
  if (!rest.rested) {
    fit.status = FitStatus::not_converged;
    fit.reason = "weights and shape did not come to rest";
  }
  // How near half of the points are, all of them: those that any shape meets count as well.
  std::vector<double> amounts(fit.points);
  std::transform(d.begin(), d.end(), amounts.begin(), [](double x) { return std::abs(x); });
  const double nearness = std::min(scale, median_distance(amounts, 0) / setting.median_of_normal);
  if (2 * count < static_cast<double>(fit.points) || nearness > 0.15 * survey.extent[0]) {
    fit.status = FitStatus::no_consensus;
    fit.reason = "no such shape explains half of the points";
  }
  add_rivals(fit, others, survey);
  // Huber (1981), 7.6: variance of an M-estimate.
  const double freedom = count * rows - static_cast<double>(free.size());
  const double mean_slope = psi_slopes / std::max(count, 1.0);
  double sigma = options.sigma;
  if (!(sigma > 0)) sigma = freedom > 0 && mean_slope > 0.05 ? std::sqrt(psi_squares / freedom) / mean_slope : 0;
  const NormalSums sums = normal_sums(frame, points, used, options.threads);
  report_fit(fit, frame, survey, points, free, sums.matrix, sigma, options.threads);
  // The extremes that count are those of the points that took part.
  const bool same_sense = std::abs(fit.largest - d[fit.largest_at]) <= 1e-9 * (1 + std::abs(fit.largest));
  fit.smallest = same_sense ? smallest : -largest;
  fit.largest = same_sense ? largest : -smallest;
  fit.smallest_at = same_sense ? smallest_at : largest_at;
  fit.largest_at = same_sense ? largest_at : smallest_at;
  fit.form = rows == 2 ? 2 * fit.largest : fit.largest - fit.smallest;
  return fit;
}

}  // namespace abbe
