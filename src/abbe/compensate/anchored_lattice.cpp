#include "abbe/compensate/anchored_lattice.h"

#include <algorithm>
#include <cmath>

#include "abbe/compensate/point_correction.h"

namespace abbe {
namespace {

/// An end of the travel that is nearer to a node than this is at the node: continuing so short a cell would enlarge the
/// rounding of its values.
constexpr double kAtNode = 1e-3;
constexpr int kTries = 6;
constexpr double kCloser = 0.75;  // the tolerance of the next try

std::size_t intervals_over(double length, double interval) {
  return length > 0 ? static_cast<std::size_t>(std::ceil(length / interval - 1e-6)) : 0;
}

double rounded_up(double interval, double multiple) { return multiple * std::ceil(interval / multiple - 1e-6); }

/// Interval and share of the way through it; below 0 and above 1 outside.
struct Continuation {
  std::size_t index = 0;
  double share = 0;
};

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

/// Nodes as close as asked for, or as there is room for.
AnchoredNodes nodes_within(const KnownTravel& travel, double anchor, double interval, double multiple,
                           std::size_t most) {
  const double length = std::max(travel.to, anchor) - std::min(travel.from, anchor);
  AnchoredNodes nodes = anchored_nodes(travel.from, travel.to, anchor, rounded_up(interval, multiple));
  // An anchor between the ends takes three nodes, however few are asked for.
  while (nodes.positions.size() > most && nodes.interval < length) {
    nodes = anchored_nodes(travel.from, travel.to, anchor, rounded_up(1.01 * nodes.interval, multiple));
  }
  return nodes;
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

CorrectionLattice continued_lattice(const CorrectionLattice& lattice,
                                    const std::vector<std::vector<double>>& positions) {
  CorrectionLattice further = lattice;
  std::size_t stride = 1;  // of the input that is continued, in both lattices
  for (std::size_t a = 0; a < positions.size(); ++a) {
    const std::vector<Continuation> places = continuations(lattice.positions[a], positions[a]);
    const std::size_t old_count = lattice.positions[a].size(), new_count = positions[a].size();
    for (std::vector<double>& values : further.corrections) {
      std::vector<double> wider(values.size() / old_count * new_count);
      for (std::size_t k = 0; k < wider.size(); ++k) {
        const Continuation& place = places[k / stride % new_count];
        const std::size_t at = (k / (stride * new_count) * old_count + place.index) * stride + k % stride;
        wider[k] = values[at] + place.share * (values[at + stride] - values[at]);
      }
      values = std::move(wider);
    }
    stride *= new_count;
  }
  further.positions = positions;
  return further;
}

AnchoredLattice build_anchored_lattice(const Machine& machine, const ErrorSet& errors,
                                       const AnchoredLatticeOptions& options) {
  AnchoredLattice best;
  LatticeOptions closer = options.lattice;
  for (int tried = 0; tried < kTries; ++tried) {
    std::vector<AnchoredNodes> nodes;
    std::vector<std::vector<double>> inside;
    const std::vector<std::vector<double>> even = lattice_nodes(machine, errors, closer);
    for (std::size_t a = 0; a < even.size(); ++a) {
      const KnownTravel travel = known_travel(machine, errors, options.lattice.inputs[a]);
      const double interval = (travel.to - travel.from) / static_cast<double>(even[a].size() - 1);
      nodes.push_back(nodes_within(travel, options.anchor[a], interval, options.step_multiple,
                                   std::min(options.lattice.most_per_axis, options.lattice.most_nodes)));
    }
    const auto count = [&] {
      double product = 1;
      for (const AnchoredNodes& one : nodes) product *= static_cast<double>(one.positions.size());
      return product;
    };
    while (count() > static_cast<double>(options.lattice.most_nodes)) {
      const auto longest = std::max_element(nodes.begin(), nodes.end(), [](const auto& a, const auto& b) {
        return a.positions.size() < b.positions.size();
      });
      const std::size_t had = longest->positions.size();
      const auto a = static_cast<std::size_t>(longest - nodes.begin());
      *longest = nodes_within(known_travel(machine, errors, options.lattice.inputs[a]), options.anchor[a],
                              longest->interval, options.step_multiple, had - 1);
      if (longest->positions.size() == had) break;
    }
    for (const AnchoredNodes& one : nodes) inside.push_back(one.inside);
    const bool no_news = tried > 0 && std::equal(nodes.begin(), nodes.end(), best.nodes.begin(),
                                                 [](const auto& a, const auto& b) { return a.interval == b.interval; });
    if (!no_news) {
      best.built = lattice_over(machine, errors, options.lattice, std::move(inside));
      best.nodes = std::move(nodes);
      if (best.built.within) break;
    }
    closer.tolerance_mm *= kCloser;
    closer.tolerance_rad *= kCloser;
  }
  std::vector<std::vector<double>> positions;
  for (const AnchoredNodes& one : best.nodes) positions.push_back(one.positions);
  best.lattice = continued_lattice(best.built.lattice, positions);
  return best;
}

}  // namespace abbe
