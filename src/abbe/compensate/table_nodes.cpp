#include "abbe/compensate/table_nodes.h"

#include <algorithm>
#include <cmath>

#include "abbe/compensate/anchored_nodes.h"
#include "abbe/errors/poses.h"

namespace abbe {
namespace {

/// A kink between two of the places looked at shows by up to a 32nd part less than it is: what is found is taken
/// larger.
constexpr double kUnseen = 1.05;

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
  for (double& error : nodes.error) error *= kUnseen;
  nodes.within = within(nodes, spacing.tolerance);
  if (spacing.anchor) continue_to(grid, nodes);
  return nodes;
}

TableNodes choose_nodes(const SampledFunctions& functions, const NodeSpacing& spacing) {
  const std::size_t most = std::max<std::size_t>(spacing.most, 2);
  std::size_t good = std::clamp<std::size_t>(spacing.fewest, 2, most);
  TableNodes best = nodes_at(functions, spacing, good);
  std::size_t bad = good;
  while (!best.within && good < most) {
    bad = good;
    good = std::min(most, 2 * good - 1);
    best = nodes_at(functions, spacing, good);
  }
  if (!best.within || best.positions.size() < 2) return best;
  // To three parts in a hundred is near enough.
  while (good > bad + 1 + good / 32) {
    const std::size_t middle = bad + (good - bad) / 2;
    TableNodes tried = nodes_at(functions, spacing, middle);
    if (tried.within) {
      good = middle;
      best = std::move(tried);
    } else {
      bad = middle;
    }
  }
  if (!(spacing.step_multiple > 0) || spacing.anchor) return best;
  const double length = spacing.to - spacing.from;
  for (std::size_t count = good; count <= std::min(most, 2 * good); ++count) {
    if (!is_multiple(length / static_cast<double>(count - 1), spacing.step_multiple)) continue;
    TableNodes rounded = nodes_at(functions, spacing, count);
    // More nodes can be worse where the function has a kink that a node was on.
    if (rounded.within) return rounded;
  }
  return best;
}

}  // namespace abbe
