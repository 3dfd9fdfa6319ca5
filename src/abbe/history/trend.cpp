#include "abbe/history/trend.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/identify/distributions.h"

namespace abbe {
namespace {

constexpr double kTwoSigmaExceedance = 0.0455 / 2;
constexpr int kHalvings = 200;

struct Line {
  double level = 0, slope = 0, u2_level = 0, u2_slope = 0, covariance = 0, squares = 0;
};

/// Weighted least squares for one value of the scatter's square.
Line line_of(const std::vector<TimedValue>& values, double scatter_squared) {
  const double last = values.back().time;
  double w = 0, wt = 0, wv = 0;
  for (const TimedValue& one : values) {
    const double weight = 1 / (one.uncertainty * one.uncertainty + scatter_squared);
    w += weight;
    wt += weight * (one.time - last);
    wv += weight * one.value;
  }
  // About the weighted means, so that nothing cancels.
  const double mean_t = wt / w, mean_v = wv / w;
  double wtt = 0, wtv = 0;
  for (const TimedValue& one : values) {
    const double weight = 1 / (one.uncertainty * one.uncertainty + scatter_squared);
    const double t = one.time - last - mean_t;
    wtt += weight * t * t;
    wtv += weight * t * (one.value - mean_v);
  }
  Line line;
  line.slope = wtv / wtt;
  line.level = mean_v - line.slope * mean_t;
  line.u2_slope = 1 / wtt;
  line.covariance = -mean_t / wtt;
  line.u2_level = 1 / w + mean_t * mean_t / wtt;
  for (const TimedValue& one : values) {
    const double weight = 1 / (one.uncertainty * one.uncertainty + scatter_squared);
    const double left = one.value - line.level - line.slope * (one.time - last);
    line.squares += weight * left * left;
  }
  return line;
}

/// Square of the scatter for which the sum of squares is its degrees of freedom.
double scatter_squared_of(const std::vector<TimedValue>& values) {
  const double freedom = static_cast<double>(values.size()) - 2;
  if (line_of(values, 0).squares <= freedom) return 0;
  double low = 0, high = 0;
  for (const TimedValue& one : values) high += one.uncertainty * one.uncertainty;
  while (line_of(values, high).squares > freedom) {
    low = high;
    high *= 4;
  }
  for (int i = 0; i < kHalvings && high - low > 1e-12 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (line_of(values, middle).squares > freedom ? low : high) = middle;
  }
  return high;
}

}  // namespace

bool Trend::drifts() const { return std::abs(slope) > coverage_factor * u_slope; }

double Trend::u_at(double t) const {
  return std::sqrt(std::max(0.0, u_level * u_level + 2 * t * covariance + t * t * u_slope * u_slope));
}

double Trend::expanded_at(double t) const { return coverage_factor * std::hypot(u_at(t), scatter.value_or(0)); }

Trend fit_trend(const std::vector<TimedValue>& values) {
  if (values.size() < 2) throw std::invalid_argument("a trend needs two values");
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i].uncertainty > 0)) throw std::invalid_argument("standard uncertainty not above 0");
    if (i > 0 && values[i].time < values[i - 1].time) throw std::invalid_argument("times decrease");
  }
  if (!(values.back().time > values.front().time)) throw std::invalid_argument("all values at one time");
  Trend trend;
  double scatter_squared = 0;
  if (values.size() > 2) {
    scatter_squared = scatter_squared_of(values);
    trend.scatter = std::sqrt(scatter_squared);
  }
  const Line line = line_of(values, scatter_squared);
  trend.level = line.level;
  trend.slope = line.slope;
  trend.u_level = std::sqrt(line.u2_level);
  trend.u_slope = std::sqrt(line.u2_slope);
  trend.covariance = line.covariance;
  const double times = std::abs(trend.slope) / trend.u_slope;
  if (scatter_squared > 0) {
    const double freedom = static_cast<double>(values.size()) - 2;
    trend.coverage_factor = student_quantile(kTwoSigmaExceedance, freedom);
    trend.probability = 2 * student_exceedance(times, freedom);
  } else {
    trend.probability = std::erfc(times / std::sqrt(2.0));
  }
  return trend;
}

Expected expected_last(const std::vector<TimedValue>& values, double wander) {
  if (values.size() < 2) throw std::invalid_argument("there is no earlier value");
  const TimedValue& last = values.back();
  const std::vector<TimedValue> earlier(values.begin(), values.end() - 1);
  Expected expected{.value = earlier.front().value};
  double factor = 2, variance = last.uncertainty * last.uncertainty;
  if (earlier.size() == 1 || !(earlier.back().time > earlier.front().time)) {
    variance += earlier.front().uncertainty * earlier.front().uncertainty;
  } else {
    const Trend trend = fit_trend(earlier);
    const double after = last.time - earlier.back().time;
    expected.value = trend.at(after);
    factor = trend.coverage_factor;
    const double u = trend.u_at(after), scatter = trend.scatter.value_or(0);
    variance += u * u + scatter * scatter;
  }
  variance += wander * (last.time - earlier.back().time);
  expected.expanded = factor * std::sqrt(variance);
  expected.is_within = std::abs(last.value - expected.value) <= expected.expanded;
  return expected;
}

std::optional<double> time_to_limit(const Trend& trend, double u_last, double limit, double longest, double wander) {
  const double scatter = trend.scatter.value_or(0);
  const auto reached = [&](double t) {
    const double u =
        std::sqrt(u_last * u_last + scatter * scatter + t * t * trend.u_slope * trend.u_slope + wander * t);
    return std::abs(trend.slope) * t + trend.coverage_factor * u >= limit;
  };
  if (reached(0)) return 0.0;
  if (!reached(longest)) return std::nullopt;
  double low = 0, high = longest;
  for (int i = 0; i < kHalvings && high - low > 1e-9 * longest; ++i) {
    const double middle = 0.5 * (low + high);
    (reached(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace abbe
