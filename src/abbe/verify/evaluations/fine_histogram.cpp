#include "abbe/verify/evaluations/fine_histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace abbe {
namespace {

constexpr unsigned kDroppedBits = 52 - 14;
constexpr std::uint64_t kFirstPlace = std::bit_cast<std::uint64_t>(FineHistogram::kSmallest) >> kDroppedBits;
constexpr std::uint64_t kLastPlace = std::bit_cast<std::uint64_t>(FineHistogram::kLargest) >> kDroppedBits;
/// Classes of one sign without that of zero; number of the class of zero.
constexpr std::size_t kFineSide = kLastPlace - kFirstPlace + 1;

/// Middle and half width of a class.
BoundedValue middle_of_class(std::size_t number) {
  if (number == kFineSide) return {0, FineHistogram::kSmallest};
  const bool negative = number < kFineSide;
  const std::uint64_t place = kFirstPlace + (negative ? kFineSide - 1 - number : number - kFineSide - 1);
  const auto low = std::bit_cast<double>(place << kDroppedBits),
             high = std::bit_cast<double>((place + 1) << kDroppedBits);
  const double middle = low + (high - low) / 2;
  return {negative ? -middle : middle, (high - low) / 2};
}

/// Type 7 percentile: between two values, each known within half of its class.
/// @param count_of   of class i, in ascending order of values
template <class CountOf>
BoundedValue percentile_of_classes(std::size_t classes, std::uint64_t count, double fraction, std::size_t first_class,
                                   const CountOf& count_of) {
  if (count == 0) return {};
  const double place = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(count - 1);
  const auto below = static_cast<std::uint64_t>(place);
  const double share = place - static_cast<double>(below);
  std::uint64_t passed = 0;
  std::size_t at = 0;
  const auto value_number = [&](std::uint64_t wanted) {
    while (at + 1 < classes && passed + count_of(at) <= wanted) passed += count_of(at++);
    return middle_of_class(first_class + at);
  };
  const BoundedValue low = value_number(below);
  if (share == 0 || below + 1 == count) return low;
  const BoundedValue high = value_number(below + 1);
  return {low.value + share * (high.value - low.value), std::max(low.bound, high.bound)};
}

}  // namespace

FineHistogram::FineHistogram() : counts_(2 * kFineSide + 1, 0) {}

std::uint32_t FineHistogram::class_of(double value) {
  const double amount = std::min(std::abs(value), kLargest);
  if (!(amount >= kSmallest)) return static_cast<std::uint32_t>(kFineSide);
  const auto place = static_cast<std::uint32_t>((std::bit_cast<std::uint64_t>(amount) >> kDroppedBits) - kFirstPlace);
  const auto zero = static_cast<std::uint32_t>(kFineSide);
  return value < 0 ? zero - 1 - place : zero + 1 + place;
}

void FineHistogram::add(std::uint32_t number, std::uint64_t count) {
  if (number >= counts_.size()) throw std::invalid_argument("a class that does not exist");
  counts_[number] += count;
}

std::uint64_t FineHistogram::count() const { return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0}); }

BoundedValue FineHistogram::percentile(double fraction) const {
  return percentile_of_classes(counts_.size(), count(), fraction, 0, [&](std::size_t i) { return counts_[i]; });
}

BoundedValue FineHistogram::percentile_of_amounts(double fraction) const {
  return percentile_of_classes(kFineSide + 1, count(), fraction, kFineSide, [&](std::size_t i) {
    return i == 0 ? counts_[kFineSide] : counts_[kFineSide + i] + counts_[kFineSide - i];
  });
}

Histogram FineHistogram::classes(double from, double to, std::size_t classes) const {
  Histogram result = histogram({}, from, to, classes);
  for (std::size_t i = 0; i < counts_.size() && result.width > 0; ++i) {
    if (counts_[i] == 0) continue;
    const double middle = middle_of_class(i).value;
    if (middle < from) {
      result.below += counts_[i];
    } else if (middle > to) {
      result.above += counts_[i];
    } else {
      const auto at = static_cast<std::size_t>((middle - from) / result.width);
      result.counts[std::min(at, classes - 1)] += counts_[i];
    }
  }
  return result;
}

std::vector<std::pair<std::uint32_t, std::uint64_t>> FineHistogram::occupied() const {
  std::vector<std::pair<std::uint32_t, std::uint64_t>> result;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (counts_[i] != 0) result.emplace_back(static_cast<std::uint32_t>(i), counts_[i]);
  }
  return result;
}

}  // namespace abbe
