#include "abbe/verify/evaluations/statistics.h"

#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

/// Type 7 percentile of values that are free to be reordered; everything before `from` is known to be smaller.
double percentile_in_place(std::vector<double>& values, double fraction, std::size_t& from) {
  const double place = fraction * static_cast<double>(values.size() - 1);
  const std::size_t below = static_cast<std::size_t>(place);
  const auto begin = values.begin();
  const auto nth = begin + static_cast<std::ptrdiff_t>(below);
  std::nth_element(begin + static_cast<std::ptrdiff_t>(from), nth, values.end());
  from = below;
  const double low = *nth;
  const double share = place - static_cast<double>(below);
  if (share == 0 || below + 1 == values.size()) return low;
  return low + share * (*std::min_element(nth + 1, values.end()) - low);
}

}  // namespace

SampleStatistics sample_statistics(std::span<const double> values, std::span<const std::uint8_t> covered) {
  SampleStatistics s;
  std::vector<double> kept;
  kept.reserve(values.size());
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!covered.empty() && !covered[i]) continue;
    const double value = values[i];
    if (kept.empty() || value > s.maximum) {
      s.maximum = value;
      s.maximum_at = i;
    }
    if (kept.empty() || value < s.minimum) s.minimum = value;
    kept.push_back(value);
    sum += value;
    squares += value * value;
  }
  s.count = kept.size();
  s.excluded = values.size() - kept.size();
  if (kept.empty()) return s;
  const double n = static_cast<double>(kept.size());
  s.mean = sum / n;
  s.rms = std::sqrt(squares / n);
  // A second pass: squares less mean square would lose the digits of a small spread.
  double spread = 0;
  for (double value : kept) spread += (value - s.mean) * (value - s.mean);
  s.deviation = kept.size() > 1 ? std::sqrt(spread / (n - 1)) : 0;
  std::size_t from = 0;
  s.median = percentile_in_place(kept, 0.5, from);
  s.p90 = percentile_in_place(kept, 0.9, from);
  s.p95 = percentile_in_place(kept, 0.95, from);
  s.p99 = percentile_in_place(kept, 0.99, from);
  return s;
}

double percentile(std::span<const double> values, double fraction) {
  if (values.empty()) return 0;
  std::vector<double> copy(values.begin(), values.end());
  std::size_t from = 0;
  return percentile_in_place(copy, std::clamp(fraction, 0.0, 1.0), from);
}

Histogram histogram(std::span<const double> values, double from, double to, std::size_t classes,
                    std::span<const std::uint8_t> covered) {
  Histogram result;
  result.from = from;
  result.counts.assign(classes, 0);
  if (classes == 0 || !(to > from)) return result;
  result.width = (to - from) / static_cast<double>(classes);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!covered.empty() && !covered[i]) continue;
    if (values[i] < from) {
      ++result.below;
    } else if (values[i] > to) {
      ++result.above;
    } else {
      const std::size_t index = static_cast<std::size_t>((values[i] - from) / result.width);
      ++result.counts[std::min(index, classes - 1)];
    }
  }
  return result;
}

}  // namespace abbe
