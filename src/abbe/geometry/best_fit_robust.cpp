#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <random>

#include "abbe/geometry/best_fit_transform.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

double quantile(std::vector<double>& values, double fraction) {
  const std::size_t index = static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(index), values.end());
  return values[index];
}

/// A whole number below `bound`, the same with every standard library.
std::size_t draw(std::mt19937_64& generator, std::size_t bound) { return generator() % bound; }

std::vector<double> distances(std::span<const Vector3d> source, std::span<const Vector3d> target,
                              const RigidTransform& target_from_source) {
  std::vector<double> result(source.size());
  for (std::size_t i = 0; i < source.size(); ++i) result[i] = (target[i] - target_from_source * source[i]).norm();
  return result;
}

/// Median distance of normally distributed points, in standard deviations of one coordinate (chi with 3 degrees of
/// freedom).
constexpr double kMedianOfChi3 = 1.5381722544550522;
/// Tukey's tuning constant for three-dimensional residuals, 95 % efficiency.
constexpr double kTukey3 = 5.18;

}  // namespace

BestFitTransform robust_best_fit_transform(std::span<const Vector3d> source, std::span<const Vector3d> target,
                                           const RobustFitOptions& options) {
  assert(source.size() == target.size());
  const std::size_t n = source.size();
  BestFitTransform best = best_fit_transform(source, target, {}, options.collinear_extent);
  best.inliers.assign(n, 1);
  // With three points nothing can be an outlier; on one line or point no triple is better than all together.
  if (n <= 3 || best.status != BestFitStatus::ok) return best;

  std::vector<Vector3d> scored_source, scored_target;
  const std::size_t scored = std::min(std::max<std::size_t>(options.scored, 4), n);
  for (std::size_t k = 0; k < scored; ++k) {
    scored_source.push_back(source[k * n / scored]);
    scored_target.push_back(target[k * n / scored]);
  }

  const auto score = [&](const RigidTransform& candidate) {
    std::vector<double> d = distances(scored_source, scored_target, candidate);
    return quantile(d, 0.55);
  };
  RigidTransform transform = best.target_from_source;
  double lowest = score(transform);
  std::mt19937_64 generator(options.seed);
  for (int trial = 0; trial < options.trials; ++trial) {
    std::array<Vector3d, 3> a, b;
    for (int k = 0; k < 3; ++k) {
      const std::size_t index = draw(generator, scored);
      a[static_cast<std::size_t>(k)] = scored_source[index];
      b[static_cast<std::size_t>(k)] = scored_target[index];
    }
    // A thin triangle fixes the rotation badly: below 3 % of the extent it is not worth scoring.
    const BestFitTransform fit = best_fit_transform(a, b, {}, 0.03 * best.extent.y());
    if (fit.status != BestFitStatus::ok) continue;
    // Triangles of different shape cannot be three good points: no need to score them.
    if (fit.rms > 3 * lowest) continue;
    const double value = score(fit.target_from_source);
    if (value < lowest) {
      lowest = value;
      transform = fit.target_from_source;
    }
  }

  std::vector<double> weights(n);
  BestFitTransform fit;
  double scale = 0;
  for (int step = 0; step < 30; ++step) {
    const std::vector<double> d = distances(source, target, transform);
    // The first step leans on the score alone, which up to 45 % outliers cannot spoil.
    std::vector<double> ordered = d;
    scale = quantile(ordered, 0.5) / kMedianOfChi3;
    // Exact data: keep a scale of rounding, so that every good point has weight.
    scale = std::max(scale, 1e-13 * (best.extent.x() + transform.translation.norm()));
    const double cut = kTukey3 * scale;
    for (std::size_t i = 0; i < n; ++i) {
      const double u = d[i] / cut;
      weights[i] = u < 1 ? (1 - u * u) * (1 - u * u) : 0;
    }
    fit = best_fit_transform(source, target, weights, options.collinear_extent);
    if (fit.status != BestFitStatus::ok) break;
    const RigidTransform change = fit.target_from_source.inverse() * transform;
    transform = fit.target_from_source;
    const double turn = (change.rotation - Eigen::Matrix3d::Identity()).norm() * best.extent.x();
    if (turn + (fit.target_from_source.rotation * change.translation).norm() < 1e-11 * best.extent.x()) break;
  }
  fit.scale = scale;
  fit.inliers.resize(n);
  std::size_t used = 0;
  for (std::size_t i = 0; i < n; ++i) used += fit.inliers[i] = weights[i] > 0 ? 1 : 0;
  // A scale as large as the cloud itself means that the "inliers" are a coincidence.
  if (fit.status == BestFitStatus::ok && (used * 2 < n || scale > 0.2 * best.extent.x())) {
    fit.status = BestFitStatus::no_consensus;
  }
  return fit;
}

}  // namespace abbe
