#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace abbe {

/// Which of many values are drawn: all, or the smallest and the largest of each of 1000 runs, in their order. Peaks
/// stay.
inline std::vector<std::size_t> thinned(const std::vector<double>& values) {
  constexpr std::size_t kRuns = 1000;
  std::vector<std::size_t> kept;
  const std::size_t n = values.size();
  if (n <= 2 * kRuns) {
    for (std::size_t i = 0; i < n; ++i) kept.push_back(i);
    return kept;
  }
  for (std::size_t run = 0; run < kRuns; ++run) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(run * n / kRuns);
    const auto end = values.begin() + static_cast<std::ptrdiff_t>((run + 1) * n / kRuns);
    const auto [low, high] = std::minmax_element(begin, end);
    const auto first = static_cast<std::size_t>(std::min(low, high) - values.begin());
    const auto second = static_cast<std::size_t>(std::max(low, high) - values.begin());
    kept.push_back(first);
    if (second != first) kept.push_back(second);
  }
  return kept;
}

}  // namespace abbe
