#include "abbe/geometry/fits/robust_reweighting.h"

#include <algorithm>
#include <cmath>

#include "abbe/geometry/fits/least_median.h"

namespace abbe::fits {
namespace {

double change(const ShapeFrame& a, const ShapeFrame& b, double size) {
  const double radius = std::abs(a.radius - b.radius), angle = std::abs(a.half_angle - b.half_angle);
  return std::max({(a.origin - b.origin).norm() / size, radius / size, angle, (a.axes - b.axes).norm()});
}

}  // namespace

Influence influence(RobustKind kind, double u) {
  switch (kind) {
    case RobustKind::huber:
      return u <= 1 ? Influence{1, 1} : Influence{1 / u, 0};
    case RobustKind::tukey: {
      const double v = 1 - u * u;
      return u < 1 ? Influence{v * v, v * (1 - 5 * u * u)} : Influence{0, 0};
    }
    case RobustKind::welsch:
      break;
  }
  const double w = std::exp(-u * u);
  return {w, w * (1 - 2 * u * u)};
}

Reweighted reweigh(const ShapeFrame& start, const FitPoints& points, const RobustSetting& setting, int most,
                   int threads) {
  Reweighted result;
  result.frame = start;
  std::vector<double> d(static_cast<std::size_t>(points.cols())), sorted(d.size()), weights(d.size());
  double last_change = std::numeric_limits<double>::infinity();  // of a distance, in scales
  for (int step = 0; step < most && !result.rested; ++step) {
    distances(result.frame, points, d, threads);
    std::transform(d.begin(), d.end(), sorted.begin(), [](double x) { return std::abs(x); });
    const double next = std::clamp(median_distance(sorted, setting.met) / setting.median_of_normal, setting.least_scale,
                                   std::max(setting.least_scale, setting.largest_scale));
    // Late steps keep the scale, which could go to and fro with the middle point.
    const double before = result.scale;
    if (step < 60) result.scale = next;
    for (std::size_t i = 0; i < d.size(); ++i) {
      weights[i] = influence(setting.kind, std::abs(d[i]) / (setting.tuning * result.scale)).weight;
    }
    Refined refined = refine(result.frame, points, weights, setting.free, setting.size, 2, threads);
    double moved_by = change(refined.frame, result.frame, setting.size);
    if (moved_by == 0 && !refined.converged) {
      // The one step led higher and was not taken: that is not rest. With damping it becomes short enough.
      refined = refine(result.frame, points, weights, setting.free, setting.size, 40, threads);
      moved_by = change(refined.frame, result.frame, setting.size);
    }
    ++result.iterations;
    result.frame = refined.frame;
    if (!std::isfinite(moved_by)) break;
    // In the distances rest means the same for all shapes, sizes and noises.
    distances(result.frame, points, sorted, threads);
    double changed = 0;
    for (std::size_t i = 0; i < d.size(); ++i)
      changed = std::max(changed, std::abs(std::abs(sorted[i]) - std::abs(d[i])));
    last_change = changed / result.scale;
    const bool scale_rests = std::abs(result.scale - before) <= 1e-9 * result.scale;
    const double rounding = 2e-15 * (setting.size + std::abs(result.frame.radius));
    result.rested = scale_rests && changed <= 1e-10 * result.scale + rounding;
    // With the scale at rounding there is nothing more to weigh.
    result.rested = result.rested || (moved_by < 1e-10 && result.scale <= 2 * setting.least_scale);
  }
  // Beside a saddle that is all but flat the steps grow by thousandths: stationary as a least-squares fit has to be.
  result.rested = result.rested || (result.iterations >= most && last_change <= 1e-6);
  return result;
}

}  // namespace abbe::fits
