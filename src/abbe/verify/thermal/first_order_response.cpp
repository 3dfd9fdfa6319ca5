#include "abbe/verify/thermal/first_order_response.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace abbe {
namespace {

constexpr double kResponseUnknowns = 3;
/// Time constants longer than this many times the readings last look like straight lines.
constexpr double kLongestConstant = 10;
/// Shorter ones, of the shortest time between readings, look like steps.
constexpr double kShortestConstant = 0.1;
constexpr std::size_t kGridSteps = 60;
/// Of the duration: nearer times may be the same after rounding.
constexpr double kShortestStep = 1e-12;
/// Of the sum of squares, in squares of the standard uncertainty: a coverage factor of 2.
constexpr double kProfileGrowth = 4;
/// A change explains at least so much, in the same squares; else it may be scatter.
constexpr double kLeastExplained = 16;
/// What a first-order response may leave, of its change over the readings, if it has a pattern.
constexpr double kLargestResidual = 0.05, kPattern = 3;

/// More readings are averaged in blocks: their noise is as small then, and they follow a response as closely.
constexpr std::size_t kMostValues = 4000;

/// The fit with one time constant.
struct LinearFit {
  double start = 0, change = 0, squares = 0;
};

class ResponseFit {
 public:
  ResponseFit(const TimeSeries& series, double from, double to) {
    const auto begin = std::lower_bound(series.time.begin(), series.time.end(), from) - series.time.begin();
    const auto end = std::upper_bound(series.time.begin(), series.time.end(), to) - series.time.begin();
    const auto first = static_cast<std::size_t>(begin), last = static_cast<std::size_t>(end);
    base_ = last > first ? series.values[first] : 0;
    block_ = last > first ? (last - first + kMostValues - 1) / kMostValues : 1;
    for (std::size_t i = first; i + block_ <= last; i += block_) {
      double time = 0, value = 0;
      for (std::size_t k = i; k < i + block_; ++k) {
        time += (series.time[k] - from) / static_cast<double>(block_);
        value += (series.values[k] - base_) / static_cast<double>(block_);
      }
      time_.push_back(time);
      values_.push_back(value);
    }
    double mean = 0;
    for (const double value : values_) mean += value / static_cast<double>(values_.size());
    for (const double value : values_) scatter_ += (value - mean) * (value - mean);
  }

  std::size_t count() const { return time_.size(); }
  /// What values are less than readings: readings that do not change have no rounding then.
  double base() const { return base_; }
  /// Readings of which each value is the mean.
  double block() const { return static_cast<double>(block_); }
  double duration() const { return time_.back() - time_.front(); }
  /// Sum of squares about the mean.
  double scatter() const { return scatter_; }
  double shortest_step() const {
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < time_.size(); ++i) shortest = std::min(shortest, time_[i] - time_[i - 1]);
    return shortest;
  }

  LinearFit fit(double constant) const {
    const double n = static_cast<double>(count());
    double mean_rise = 0, mean_value = 0;
    for (std::size_t i = 0; i < count(); ++i) {
      mean_rise += rise(i, constant) / n;
      mean_value += values_[i] / n;
    }
    double xx = 0, xy = 0;
    for (std::size_t i = 0; i < count(); ++i) {
      const double x = rise(i, constant) - mean_rise;
      xx += x * x;
      xy += x * (values_[i] - mean_value);
    }
    LinearFit result;
    result.change = xx > 0 ? xy / xx : 0;
    result.start = mean_value - result.change * mean_rise;
    for (std::size_t i = 0; i < count(); ++i) {
      const double residual = values_[i] - result.start - result.change * rise(i, constant);
      result.squares += residual * residual;
    }
    return result;
  }

  /// Readings that one independent reading is worth.
  double correlation_length(const LinearFit& fit, double constant) const {
    if (!(fit.squares > 0)) return 1;
    std::vector<double> residuals;
    for (std::size_t i = 0; i < count(); ++i) {
      residuals.push_back(values_[i] - fit.start - fit.change * rise(i, constant));
    }
    double sum = 1;
    for (std::size_t lag = 1; lag < count() / 2; ++lag) {
      double product = 0;
      for (std::size_t i = lag; i < count(); ++i) product += residuals[i] * residuals[i - lag];
      const double correlation = product / fit.squares;
      if (correlation < 2 / std::sqrt(static_cast<double>(count()))) break;
      sum += 2 * correlation;
    }
    return sum;
  }

  /// Change of the model from the first to the last reading.
  double change_over_readings(const LinearFit& fit, double constant) const {
    return fit.change * (rise(count() - 1, constant) - rise(0, constant));
  }

 private:
  double rise(std::size_t i, double constant) const { return -std::expm1(-time_[i] / constant); }

  std::size_t block_ = 1;
  std::vector<double> time_, values_;
  double base_ = 0, scatter_ = 0;
};

/// The logarithm of the time constant with the smallest sum of squares; an end of the range if it is there.
double best_constant(const ResponseFit& fit, double low, double high) {
  const double step = (high - low) / kGridSteps;
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i <= kGridSteps; ++i) {
    const double squares = fit.fit(std::exp(low + static_cast<double>(i) * step)).squares;
    if (squares >= least) continue;
    least = squares;
    best = i;
  }
  if (best == 0 || best == kGridSteps) return best == 0 ? low : high;
  // Golden section between the neighbours of the best.
  constexpr double kGolden = 0.6180339887498949;
  double a = low + static_cast<double>(best - 1) * step, b = low + static_cast<double>(best + 1) * step;
  double c = b - kGolden * (b - a), d = a + kGolden * (b - a);
  double at_c = fit.fit(std::exp(c)).squares, at_d = fit.fit(std::exp(d)).squares;
  while (b - a > 1e-8) {
    if (at_c < at_d) {
      b = d;
      d = c;
      at_d = at_c;
      c = b - kGolden * (b - a);
      at_c = fit.fit(std::exp(c)).squares;
    } else {
      a = c;
      c = d;
      at_c = at_d;
      d = a + kGolden * (b - a);
      at_d = fit.fit(std::exp(d)).squares;
    }
  }
  return (a + b) / 2;
}

/// How far from the best the sum of squares first exceeds a limit, upwards or downwards, as a time constant; nothing if
/// it does not within the range. Both are logarithms.
std::optional<double> bound_of_constant(const ResponseFit& fit, double best, double end, double limit) {
  const double direction = end > best ? 1 : -1;
  double inside = best, distance = 1e-7;
  for (;;) {
    const double outside =
        direction * (best + direction * distance) >= direction * end ? end : best + direction * distance;
    if (fit.fit(std::exp(outside)).squares > limit) {
      double far = outside;
      for (int i = 0; i < 40; ++i) {
        const double middle = (inside + far) / 2;
        (fit.fit(std::exp(middle)).squares > limit ? far : inside) = middle;
      }
      return std::exp(far);
    }
    if (outside == end) return std::nullopt;
    inside = outside;
    distance *= 1.5;
  }
}

}  // namespace

double FirstOrderResponse::at(double time) const { return start - change * std::expm1(-(time - from) / time_constant); }

FirstOrderResponse first_order_response(const TimeSeries& series, double from, double to, double reading_uncertainty) {
  FirstOrderResponse result;
  result.from = from;
  result.to = to;
  const ResponseFit fit(series, from, to);
  result.status = ResponseStatus::too_few_readings;
  if (fit.count() < kLeastResponseReadings || !(fit.duration() > 0)) return result;
  result.status = ResponseStatus::no_change;
  if (!(fit.scatter() > 0)) return result;

  const double step = std::max(fit.shortest_step(), kShortestStep * fit.duration());
  const double shortest = std::log(kShortestConstant * step), longest = std::log(kLongestConstant * fit.duration());
  const double best = best_constant(fit, shortest, longest), constant = std::exp(best);
  const LinearFit found = fit.fit(constant);
  const double n = static_cast<double>(fit.count());
  result.correlation_length = fit.correlation_length(found, constant);
  const double independent = n / result.correlation_length;
  const double stated = reading_uncertainty * reading_uncertainty / fit.block();
  // As many as are independent; at least one more than unknowns, else nothing could be said at all.
  const double variance =
      std::max(stated, found.squares / (std::max(independent, kResponseUnknowns + 1) - kResponseUnknowns));
  result.residual_rms = std::sqrt(found.squares / (n - kResponseUnknowns));
  result.status = ResponseStatus::not_first_order;
  const double change = std::abs(fit.change_over_readings(found, constant));
  if (result.correlation_length > kPattern && result.residual_rms > kLargestResidual * change) return result;
  result.status = ResponseStatus::no_change;
  if (fit.scatter() - found.squares < kLeastExplained * variance) return result;
  result.status = ResponseStatus::not_identified;
  if (best == shortest || best == longest) return result;
  result.status = ResponseStatus::too_few_readings;
  if (independent < kResponseUnknowns + 1) return result;
  result.status = ResponseStatus::not_identified;
  const double limit = found.squares + kProfileGrowth * variance;
  const std::optional<double> low = bound_of_constant(fit, best, shortest, limit);
  const std::optional<double> high = bound_of_constant(fit, best, longest, limit);
  if (!low || !high) return result;
  result.status = ResponseStatus::done;
  result.start = fit.base() + found.start;
  result.change = found.change;
  result.time_constant = constant;
  result.uncertainty = std::max(constant - *low, *high - constant) / 2;
  return result;
}

}  // namespace abbe
