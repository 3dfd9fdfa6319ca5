#include "abbe/compensate/tables/anchored_nodes.h"

#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

/// An end of the travel that is nearer to a node than this is at the node: continuing so short a cell would enlarge the
/// rounding of its values.
constexpr double kAtNode = 1e-3;

std::size_t intervals_over(double length, double interval) {
  return length > 0 ? static_cast<std::size_t>(std::ceil(length / interval - 1e-6)) : 0;
}

double rounded_up(double interval, double multiple) {
  return multiple > 0 ? multiple * std::ceil(interval / multiple - 1e-6) : interval;
}

}  // namespace

AnchoredNodes anchored_nodes(double from, double to, double anchor, double interval) {
  AnchoredNodes nodes;
  nodes.interval = interval;
  nodes.anchor = intervals_over(anchor - std::min(from, anchor), interval);
  const std::size_t above = intervals_over(std::max(to, anchor) - anchor, interval);
  nodes.inside.push_back(from);
  for (std::size_t k = 0; k <= nodes.anchor + above; ++k) {
    const double position = anchor + interval * (static_cast<double>(k) - static_cast<double>(nodes.anchor));
    nodes.positions.push_back(position);
    if (position > from + kAtNode && position < to - kAtNode) nodes.inside.push_back(position);
  }
  nodes.inside.push_back(to);
  return nodes;
}

AnchoredNodes anchored_nodes_within(double from, double to, double anchor, double interval, double multiple,
                                    std::size_t most) {
  const double length = std::max(to, anchor) - std::min(from, anchor);
  AnchoredNodes nodes = anchored_nodes(from, to, anchor, rounded_up(interval, multiple));
  while (nodes.positions.size() > most && nodes.interval < length) {
    nodes = anchored_nodes(from, to, anchor, rounded_up(1.01 * nodes.interval, multiple));
  }
  return nodes;
}

std::vector<Continuation> continuations(const std::vector<double>& from, const std::vector<double>& to) {
  // What is further out than the first node outside has its value.
  double lowest = from.front(), highest = from.back();
  for (const double position : to) {
    if (position < from.front()) lowest = position;
  }
  for (auto position = to.rbegin(); position != to.rend(); ++position) {
    if (*position > from.back()) highest = *position;
  }
  std::vector<Continuation> found;
  for (const double position : to) {
    const double held = std::clamp(position, lowest, highest);
    const auto after = std::upper_bound(from.begin() + 1, from.end() - 1, held);
    const auto index = static_cast<std::size_t>(after - from.begin()) - 1;
    found.push_back({index, (held - from[index]) / (from[index + 1] - from[index])});
  }
  return found;
}

}  // namespace abbe
