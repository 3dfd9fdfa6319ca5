#include "abbe/verify/evaluations/statistics.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "abbe/verify/evaluations/values_at_places.h"

namespace abbe {
namespace {

/// So many values are told apart by their leading bits first.
constexpr std::size_t kManyValues = 20000;
/// Sign, exponent and six bits of the mantissa: a class is at most 1/64 wide, of its values.
constexpr int kClassBits = 18;

/// Class of a value: greater values have the same or a greater one.
std::size_t leading_class(double value) {
  // Adding zero takes the sign from a zero, which equals the other one.
  const auto bits = std::bit_cast<std::uint64_t>(value + 0.0), sign = std::uint64_t{1} << 63U;
  return static_cast<std::size_t>(((bits & sign) != 0 ? ~bits : bits | sign) >> (64 - kClassBits));
}

/// @param places  ascending
std::vector<double> places_in(std::vector<double>& values, std::span<const std::size_t> places) {
  std::vector<double> found;
  std::size_t from = 0;
  for (const std::size_t place : places) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(place);
    // Everything in front of `from` is known to be no greater.
    if (found.empty() || place > from) {
      std::nth_element(values.begin() + static_cast<std::ptrdiff_t>(from), at, values.end());
    }
    from = place;
    found.push_back(*at);
  }
  return found;
}

/// @param places  ascending
std::vector<double> places_by_classes(std::span<const double> values, std::span<const std::size_t> places) {
  constexpr std::size_t kClasses = std::size_t{1} << kClassBits;
  std::vector<std::uint32_t> bucket_of(kClasses);
  for (const double value : values) ++bucket_of[leading_class(value)];
  struct Bucket {
    std::size_t below = 0;  // values of lower classes
    std::vector<double> values{};
    std::vector<std::size_t> places{};  // within
  };
  std::vector<Bucket> buckets(1);  // the first one: classes in which no place is
  std::size_t below = 0, next = 0;
  for (std::uint32_t& bucket : bucket_of) {
    const std::size_t count = bucket;
    bucket = 0;
    if (next < places.size() && places[next] < below + count) {
      bucket = static_cast<std::uint32_t>(buckets.size());
      buckets.push_back({.below = below});
      buckets.back().values.reserve(count);
      for (; next < places.size() && places[next] < below + count; ++next) {
        buckets.back().places.push_back(places[next] - below);
      }
    }
    below += count;
  }
  for (const double value : values) {
    const std::uint32_t bucket = bucket_of[leading_class(value)];
    if (bucket != 0) buckets[bucket].values.push_back(value);
  }
  std::vector<double> found;
  for (Bucket& bucket : buckets) {
    const std::vector<double> here = places_in(bucket.values, bucket.places);
    found.insert(found.end(), here.begin(), here.end());
  }
  return found;
}

/// Where a percentile lies between two places in ascending order.
struct PercentilePlace {
  std::size_t below = 0;
  double share = 0;  ///< of the way to the next place

  PercentilePlace(double fraction, std::size_t count) {
    const double place = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(count - 1);
    below = static_cast<std::size_t>(place);
    share = below + 1 == count ? 0 : place - static_cast<double>(below);
  }
};

/// Type 7 percentiles. @param fractions  of at least one value
void find_percentiles(std::span<const double> values, std::span<const double> fractions, std::span<double> found) {
  std::vector<std::size_t> places;
  for (const double fraction : fractions) {
    const PercentilePlace place(fraction, values.size());
    places.push_back(place.below);
    places.push_back(place.share == 0 ? place.below : place.below + 1);
  }
  const std::vector<double> at = values_at_places(values, places);
  for (std::size_t k = 0; k < fractions.size(); ++k) {
    const double low = at[2 * k], share = PercentilePlace(fractions[k], values.size()).share;
    found[k] = share == 0 ? low : low + share * (at[2 * k + 1] - low);
  }
}

}  // namespace

std::vector<double> values_at_places(std::span<const double> values, std::span<const std::size_t> places) {
  std::vector<std::size_t> ascending(places.begin(), places.end());
  std::sort(ascending.begin(), ascending.end());
  std::vector<double> found;
  if (values.size() < kManyValues) {
    std::vector<double> copy(values.begin(), values.end());
    found = places_in(copy, ascending);
  } else {
    found = places_by_classes(values, ascending);
  }
  std::vector<double> result;
  for (const std::size_t place : places) {
    const auto at = std::lower_bound(ascending.begin(), ascending.end(), place);
    result.push_back(found[static_cast<std::size_t>(at - ascending.begin())]);
  }
  return result;
}

SampleStatistics sample_statistics(std::span<const double> values, std::span<const std::uint8_t> covered) {
  if (covered.empty()) return sample_statistics(values, std::span<const double>(), std::span<double>());
  std::vector<double> kept;
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!covered[i]) continue;
    kept.push_back(values[i]);
    numbers.push_back(i);
  }
  SampleStatistics s = sample_statistics(kept, std::span<const double>(), std::span<double>());
  s.excluded = values.size() - kept.size();
  if (!kept.empty()) s.maximum_at = numbers[s.maximum_at];
  return s;
}

SampleStatistics sample_statistics(std::span<const double> values, std::span<const double> fractions,
                                   std::span<double> found) {
  SampleStatistics s;
  s.count = values.size();
  if (values.empty()) return s;
  s.minimum = s.maximum = values.front();
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i];
    if (value > s.maximum) {
      s.maximum = value;
      s.maximum_at = i;
    }
    if (value < s.minimum) s.minimum = value;
    sum += value;
    squares += value * value;
  }
  const double n = static_cast<double>(values.size());
  s.mean = sum / n;
  s.rms = std::sqrt(squares / n);
  // A second pass: squares less mean square would lose the digits of a small spread.
  double spread = 0;
  for (const double value : values) spread += (value - s.mean) * (value - s.mean);
  s.deviation = values.size() > 1 ? std::sqrt(spread / (n - 1)) : 0;
  std::vector<double> all = {0.5, 0.9, 0.95, 0.99};
  all.insert(all.end(), fractions.begin(), fractions.end());
  std::vector<double> percentiles(all.size());
  find_percentiles(values, all, percentiles);
  s.median = percentiles[0];
  s.p90 = percentiles[1];
  s.p95 = percentiles[2];
  s.p99 = percentiles[3];
  std::copy(percentiles.begin() + 4, percentiles.end(), found.begin());
  return s;
}

double percentile(std::span<const double> values, double fraction) {
  if (values.empty()) return 0;
  double found = 0;
  find_percentiles(values, {&fraction, 1}, {&found, 1});
  return found;
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
