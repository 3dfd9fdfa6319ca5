#include "abbe/identify/time_blocks.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace abbe {

std::vector<TimeBlocks> divide_by_time(const std::vector<std::vector<double>>& time_s, std::size_t blocks,
                                       double gap_s) {
  std::size_t readings = 0, first = 0;
  for (const std::vector<double>& times : time_s) readings += times.size();
  std::vector<TimeBlocks> result(time_s.size());
  std::vector<std::pair<double, double>> spans;
  for (std::size_t o = 0; o < time_s.size(); ++o) {
    const std::vector<double>& times = time_s[o];
    const double share =
        static_cast<double>(blocks * times.size()) / static_cast<double>(std::max<std::size_t>(1, readings));
    const std::size_t own = std::max<std::size_t>(2, static_cast<std::size_t>(std::lround(share)));
    std::vector<std::size_t> order(times.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return times[a] < times[b]; });
    result[o].block.resize(times.size());
    std::size_t block = 0;
    spans.resize(first + own, {INFINITY, -INFINITY});
    for (std::size_t i = 0; i < order.size(); ++i) {
      // A block begins where its share of the readings does, but never within one time.
      const bool same_time = i > 0 && times[order[i]] == times[order[i - 1]];
      if (!same_time) block = std::max(block, i * own / order.size());
      result[o].block[order[i]] = first + block;
      auto& [from, to] = spans[first + block];
      from = std::min(from, times[order[i]]);
      to = std::max(to, times[order[i]]);
    }
    first += own;
  }
  std::size_t before = 0;
  for (std::size_t o = 0; o < result.size(); ++o) {
    result[o].blocks = first;
    const std::size_t end = o + 1 < result.size() && !result[o + 1].block.empty()
                                ? *std::min_element(result[o + 1].block.begin(), result[o + 1].block.end())
                                : first;
    if (gap_s > 0) {
      result[o].near.assign(time_s[o].size() * first, 0);
      for (std::size_t k = 0; k < time_s[o].size(); ++k) {
        for (std::size_t b = before; b < end; ++b) {
          const double time = time_s[o][k];
          result[o].near[k * first + b] = time > spans[b].first - gap_s && time < spans[b].second + gap_s ? 1 : 0;
        }
      }
    }
    before = end;
  }
  return result;
}

}  // namespace abbe
