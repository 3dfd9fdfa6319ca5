#include "abbe/identify/robust_loss.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace abbe {
namespace {

using PerRows = std::array<double, 6>;
// Roots of efficiency(c) = 0.95 with the asymptotic efficiency A^2 / B of docs/identification.md; the test integrates
// it.
constexpr PerRows kHuber = {1.344998, 1.501141, 1.627988, 1.731073, 1.812018, 1.869338};
constexpr PerRows kCauchy = {2.384947, 2.548638, 2.665568, 2.751581, 2.815403, 2.862372};
constexpr PerRows kTukey = {4.685065, 5.122986, 5.490249, 5.810316, 6.096266, 6.356216};
constexpr PerRows kMedianNorm = {0.6744898, 1.1774100, 1.5381723, 1.8321283, 2.0860154, 2.3126004};

double per_rows(const PerRows& table, int rows) { return table[static_cast<std::size_t>(std::clamp(rows, 1, 6) - 1)]; }

}  // namespace

double tuning_constant(LossKind kind, int rows) {
  switch (kind) {
    case LossKind::huber:
      return per_rows(kHuber, rows);
    case LossKind::cauchy:
      return per_rows(kCauchy, rows);
    case LossKind::tukey:
      return per_rows(kTukey, rows);
    case LossKind::none:
      break;
  }
  return 0;
}

double median_norm(int rows) { return per_rows(kMedianNorm, rows); }

double median_scale(std::vector<double> scaled_norms) {
  if (scaled_norms.empty()) return 1;
  const auto middle = scaled_norms.begin() + static_cast<std::ptrdiff_t>(scaled_norms.size() / 2);
  std::nth_element(scaled_norms.begin(), middle, scaled_norms.end());
  return *middle;
}

LossMoments loss_moments_at(const Loss& loss, int rows, double norm) {
  const double w = loss.weight(norm, rows), along = w + norm * loss.weight_slope(norm, rows), m = rows;
  return {((m - 1) * w + along) / m, w * w * norm * norm / m, ((m - 1) * w * w + along * along) / m};
}

LossMoments loss_moments(const Loss& loss, int rows) {
  if (loss.kind == LossKind::none) return {1, loss.scale * loss.scale, 1};
  constexpr int kSteps = 4000;
  const double m = rows, to = std::sqrt(m) + 8, step = to / kSteps;
  const double constant = (1 - m / 2) * std::log(2.0) - std::lgamma(m / 2);
  LossMoments sum{0, 0, 0};
  for (int i = 0; i < kSteps; ++i) {
    const double d = (i + 0.5) * step;
    const double share = step * std::exp(constant + (m - 1) * std::log(d) - d * d / 2);
    const LossMoments at = loss_moments_at(loss, rows, d * loss.scale);
    sum.slope += share * at.slope;
    sum.square += share * at.square;
    sum.slope_square += share * at.slope_square;
  }
  return sum;
}

double Loss::weight_slope(double norm, int rows) const {
  if (kind == LossKind::none) return 0;
  const double c = scale * (tuning > 0 ? tuning : tuning_constant(kind, rows));
  const double u = norm / c;
  switch (kind) {
    case LossKind::huber:
      return u <= 1 ? 0 : -1 / (u * u * c);
    case LossKind::cauchy:
      return -2 * u / ((1 + u * u) * (1 + u * u) * c);
    case LossKind::tukey:
      return u <= 1 ? -4 * u * (1 - u * u) / c : 0;
    case LossKind::none:
      break;
  }
  return 0;
}

double Loss::weight(double norm, int rows) const {
  if (kind == LossKind::none) return 1;
  const double c = tuning > 0 ? tuning : tuning_constant(kind, rows);
  const double u = norm / (scale * c);
  switch (kind) {
    case LossKind::huber:
      return u <= 1 ? 1 : 1 / u;
    case LossKind::cauchy:
      return 1 / (1 + u * u);
    case LossKind::tukey:
      return u <= 1 ? (1 - u * u) * (1 - u * u) : (u > 1 ? 0 : u);
    case LossKind::none:
      break;
  }
  return 1;
}

double Loss::cost(double norm, int rows) const {
  if (kind == LossKind::none) return norm * norm / 2;
  const double c = (tuning > 0 ? tuning : tuning_constant(kind, rows)) * scale;
  const double u = norm / c;
  switch (kind) {
    case LossKind::huber:
      return u <= 1 ? norm * norm / 2 : c * (norm - c / 2);
    case LossKind::cauchy:
      return c * c / 2 * std::log1p(u * u);
    case LossKind::tukey: {
      if (u > 1) return c * c / 6;
      const double rest = 1 - u * u;
      return c * c / 6 * (1 - rest * rest * rest);
    }
    case LossKind::none:
      break;
  }
  return 0;
}

}  // namespace abbe
