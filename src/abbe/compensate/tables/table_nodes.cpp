#include "abbe/compensate/tables/table_nodes.h"

#include <algorithm>
#include <cmath>

#include "abbe/compensate/tables/anchored_nodes.h"
#include "abbe/errors/poses.h"

namespace abbe {
namespace {

/// A kink between two of the places looked at shows by up to a 32nd part less than it is: what is found is taken
/// larger.
constexpr double kKinkMargin = 1.05;

/// True where `step` is a whole number of multiples, to what a double keeps of it.
bool is_multiple(double step, double multiple) {
  const double ratio = step / multiple;
  return ratio > 0.5 && std::abs(ratio - std::round(ratio)) < 1e-9 * ratio;
}

bool within(const TableNodes& nodes, const std::vector<double>& tolerance) {
  for (std::size_t f = 0; f < tolerance.size(); ++f) {
    if (!(nodes.error[f] <= tolerance[f])) return false;
  }
  return true;
}

/// Instead of nodes at the ends of the travel those of a grid that may lie further out.
void continue_to(const AnchoredNodes& grid, TableNodes& nodes) {
  const std::vector<Continuation> places = continuations(nodes.positions, grid.positions);
  for (std::vector<double>& values : nodes.values) {
    std::vector<double> wider;
    for (const Continuation& place : places) {
      wider.push_back(values[place.index] + place.share * (values[place.index + 1] - values[place.index]));
    }
    values = std::move(wider);
  }
  nodes.positions = grid.positions;
}

}  // namespace

TableNodes nodes_at(const SampledFunctions& functions, const NodeSpacing& spacing, std::size_t count) {
  TableNodes nodes;
  nodes.error.assign(spacing.tolerance.size(), 0.0);
  if (!(spacing.to > spacing.from)) {
    nodes.positions = {spacing.from};
    functions(nodes.positions, nodes.values);
    return nodes;
  }
  count = std::max<std::size_t>(count, 2);
  AnchoredNodes grid;
  if (spacing.anchor) {
    const double interval = (spacing.to - spacing.from) / static_cast<double>(count - 1);
    grid =
        anchored_nodes_within(spacing.from, spacing.to, *spacing.anchor, interval, spacing.step_multiple, spacing.most);
    nodes.positions = grid.inside;
  } else {
    nodes.positions = evenly_spaced(spacing.from, spacing.to, count);
    nodes.positions.back() = spacing.to;
  }
  functions(nodes.positions, nodes.values);
  const std::size_t intervals = nodes.positions.size() - 1;
  const std::size_t places = std::max<std::size_t>(16, spacing.places / intervals + 1);
  // In pieces, so that long tables need no more memory than short ones.
  std::vector<std::vector<double>> found;
  std::vector<double> positions;
  std::size_t first = 0;
  while (first < intervals) {
    const std::size_t last = std::min(intervals, first + 1 + 4096 / places);
    positions.clear();
    for (std::size_t i = first; i < last; ++i) {
      for (std::size_t j = 1; j < places; ++j) {
        const double share = static_cast<double>(j) / static_cast<double>(places);
        positions.push_back(nodes.positions[i] + share * (nodes.positions[i + 1] - nodes.positions[i]));
      }
    }
    functions(positions, found);
    for (std::size_t f = 0; f < spacing.tolerance.size(); ++f) {
      std::size_t k = 0;
      for (std::size_t i = first; i < last; ++i) {
        for (std::size_t j = 1; j < places; ++j, ++k) {
          const double share = static_cast<double>(j) / static_cast<double>(places);
          const double line = nodes.values[f][i] + share * (nodes.values[f][i + 1] - nodes.values[f][i]);
          nodes.error[f] = std::max(nodes.error[f], std::abs(line - found[f][k]));
        }
      }
    }
    first = last;
  }
  for (double& error : nodes.error) error *= kKinkMargin;
  nodes.within = within(nodes, spacing.tolerance);
  if (spacing.anchor) continue_to(grid, nodes);
  return nodes;
}

namespace {

/// Fewest intervals with which every kink is on a node (to a thousandth of an interval: the corrections themselves move
/// it by as much as they are), or 0.
std::size_t intervals_on_kinks(const NodeSpacing& spacing, std::size_t most) {
  std::vector<double> shares;
  for (const double kink : spacing.kinks) {
    const double share = (kink - spacing.from) / (spacing.to - spacing.from);
    if (share > 1e-9 && share < 1 - 1e-9) shares.push_back(share);
  }
  for (std::size_t intervals = 1; !shares.empty() && intervals <= most; ++intervals) {
    if (std::all_of(shares.begin(), shares.end(), [&](double share) {
          const double place = share * static_cast<double>(intervals);
          return std::abs(place - std::round(place)) < 1e-3;
        })) {
      return intervals;
    }
  }
  return 0;
}

/// Few multiples of `unit` intervals.
TableNodes fewest_nodes(const SampledFunctions& functions, const NodeSpacing& spacing, std::size_t unit) {
  const std::size_t most = std::max<std::size_t>((std::max<std::size_t>(spacing.most, 2) - 1) / unit, 1);
  const auto nodes_of = [&](std::size_t units) { return units * unit + 1; };
  const std::size_t wanted = std::max<std::size_t>(spacing.fewest, 2) - 1;
  std::size_t good = std::clamp<std::size_t>((wanted + unit - 1) / unit, 1, most);
  TableNodes best = nodes_at(functions, spacing, nodes_of(good));
  std::size_t bad = good;
  while (!best.within && good < most) {
    bad = good;
    good = std::min(most, 2 * good);
    best = nodes_at(functions, spacing, nodes_of(good));
  }
  if (!best.within || best.positions.size() < 2) return best;
  // To three parts in a hundred is near enough.
  while (good > bad + 1 + (good + 1) / 32) {
    const std::size_t middle = bad + (good - bad) / 2;
    TableNodes tried = nodes_at(functions, spacing, nodes_of(middle));
    if (tried.within) {
      good = middle;
      best = std::move(tried);
    } else {
      bad = middle;
    }
  }
  if (!(spacing.step_multiple > 0) || spacing.anchor) return best;
  const double length = spacing.to - spacing.from;
  for (std::size_t units = good; units <= most && nodes_of(units) <= 2 * nodes_of(good); ++units) {
    if (!is_multiple(length / static_cast<double>(units * unit), spacing.step_multiple)) continue;
    TableNodes rounded = nodes_at(functions, spacing, nodes_of(units));
    // More nodes can be worse where the function has a kink that a node was on.
    if (rounded.within) return rounded;
  }
  return best;
}

}  // namespace

TableNodes choose_nodes(const SampledFunctions& functions, const NodeSpacing& spacing) {
  const std::size_t unit =
      spacing.to > spacing.from ? intervals_on_kinks(spacing, std::max<std::size_t>(spacing.most, 2) - 1) : 0;
  if (unit < 2) return fewest_nodes(functions, spacing, 1);
  TableNodes on_kinks = fewest_nodes(functions, spacing, unit);
  if (!on_kinks.within) return fewest_nodes(functions, spacing, 1);
  NodeSpacing fewer = spacing;
  fewer.most = on_kinks.positions.size() - 1;
  TableNodes anywhere = fewest_nodes(functions, fewer, 1);
  return anywhere.within && anywhere.positions.size() < on_kinks.positions.size() ? anywhere : on_kinks;
}

std::vector<double> kinks_of(const ErrorSet& errors, std::size_t axis) {
  std::vector<double> kinks;
  for (const ErrorMotion& motion : errors.motions) {
    if (motion.axis != axis || motion.basis.kind != BasisKind::table_linear) continue;
    kinks.insert(kinks.end(), motion.basis.nodes.begin(), motion.basis.nodes.end());
  }
  return kinks;
}

}  // namespace abbe
