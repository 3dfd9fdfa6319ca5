#include "abbe/verify/thermal/time_series.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <deque>

namespace abbe {
namespace {

/// A window that ends so little behind the last reading, of its length, ends at it.
constexpr double kRounding = 1e-9;

/// Never beyond both values, whatever the rounding.
double between(double t, double t0, double v0, double t1, double v1) { return std::lerp(v0, v1, (t - t0) / (t1 - t0)); }

/// The value at a time that is not before the time `at`, which moves on to the last reading before or at it.
double value_from(const TimeSeries& series, double time, std::size_t& at) {
  while (at + 1 < series.time.size() && series.time[at + 1] <= time) ++at;
  if (at + 1 == series.time.size()) return series.values[at];
  return between(time, series.time[at], series.values[at], series.time[at + 1], series.values[at + 1]);
}

/// The same readings with the time running backwards.
TimeSeries reversed(const TimeSeries& series) {
  TimeSeries result{series.name, {}, {series.values.rbegin(), series.values.rend()}};
  for (auto time = series.time.rbegin(); time != series.time.rend(); ++time) result.time.push_back(-*time);
  return result;
}

/// Largest range within the windows that begin at a reading; those that would end behind the last reading are left out.
double largest_range_from_readings(const TimeSeries& series, double window) {
  const std::size_t n = series.time.size();
  std::deque<std::size_t> lows, highs;  // candidates for the smallest and largest value, in the order of time
  double largest = 0;
  std::size_t taken = 0, at = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double end = series.time[i] + window;
    if (end > series.to() + kRounding * window) break;
    for (; taken < n && series.time[taken] <= end; ++taken) {
      while (!lows.empty() && series.values[lows.back()] >= series.values[taken]) lows.pop_back();
      while (!highs.empty() && series.values[highs.back()] <= series.values[taken]) highs.pop_back();
      lows.push_back(taken);
      highs.push_back(taken);
    }
    while (lows.front() < i) lows.pop_front();
    while (highs.front() < i) highs.pop_front();
    const double last = value_from(series, end, at);
    largest =
        std::max(largest, std::max(series.values[highs.front()], last) - std::min(series.values[lows.front()], last));
  }
  return largest;
}

double largest_change_from_readings(const TimeSeries& series, double window) {
  double largest = 0;
  std::size_t at = 0;
  for (std::size_t i = 0; i < series.time.size(); ++i) {
    const double end = series.time[i] + window;
    if (end > series.to() + kRounding * window) break;
    largest = std::max(largest, std::abs(value_from(series, end, at) - series.values[i]));
  }
  return largest;
}

}  // namespace

double value_at(const TimeSeries& series, double time) {
  assert(!series.time.empty());
  const auto next = std::upper_bound(series.time.begin(), series.time.end(), time);
  if (next == series.time.begin()) return series.values.front();
  auto at = static_cast<std::size_t>(next - series.time.begin()) - 1;
  return value_from(series, time, at);
}

SeriesRange range_between(const TimeSeries& series, double from, double to) {
  const double first = value_at(series, from), last = value_at(series, to);
  SeriesRange range{first, first, from, from};
  const auto take = [&](double time, double value) {
    if (value < range.low) {
      range.low = value;
      range.low_at = time;
    }
    if (value > range.high) {
      range.high = value;
      range.high_at = time;
    }
  };
  const auto begin = std::upper_bound(series.time.begin(), series.time.end(), from);
  for (auto time = begin; time != series.time.end() && *time < to; ++time) {
    take(*time, series.values[static_cast<std::size_t>(time - series.time.begin())]);
  }
  take(to, last);
  return range;
}

double longest_gap(const TimeSeries& series, double from, double to) {
  double longest = 0;
  for (std::size_t i = 1; i < series.time.size(); ++i) {
    if (series.time[i] <= from || series.time[i - 1] >= to) continue;
    longest = std::max(longest, series.time[i] - series.time[i - 1]);
  }
  return longest;
}

double largest_range_within(const TimeSeries& series, double window) {
  return std::max(largest_range_from_readings(series, window), largest_range_from_readings(reversed(series), window));
}

double largest_change_over(const TimeSeries& series, double window) {
  return std::max(largest_change_from_readings(series, window), largest_change_from_readings(reversed(series), window));
}

double mean_over_time(const TimeSeries& series) {
  if (series.time.size() == 1) return series.values.front();
  double sum = 0;
  for (std::size_t i = 1; i < series.time.size(); ++i) {
    sum += (series.time[i] - series.time[i - 1]) / series.duration() * (series.values[i - 1] + series.values[i]) / 2;
  }
  return sum;
}

TimeSeries difference_of(const TimeSeries& a, const TimeSeries& b, const std::string& name) {
  TimeSeries result{name, {}, {}};
  for (std::size_t i = 0, k = 0; i < a.time.size(); ++i) {
    while (k < b.time.size() && b.time[k] < a.time[i]) ++k;
    if (k == b.time.size() || b.time[k] != a.time[i]) continue;
    result.time.push_back(a.time[i]);
    result.values.push_back(a.values[i] - b.values[k]);
  }
  return result;
}

}  // namespace abbe
