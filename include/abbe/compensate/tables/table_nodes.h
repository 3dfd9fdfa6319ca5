#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "abbe/errors/error_set.h"

namespace abbe {

/// Functions of one position that share the nodes of a table: values[function][k] at positions[k].
using SampledFunctions =
    std::function<void(std::span<const double> positions, std::vector<std::vector<double>>& values)>;

struct NodeSpacing {
  double from = 0;  ///< mm or rad
  double to = 0;
  std::vector<double> tolerance;  ///< [functions] largest difference between function and straight lines, its unit
  std::size_t fewest = 2;         ///< nodes
  std::size_t most = 10000;       ///< nodes that the table can have
  std::size_t places = 1000;      ///< where the difference is looked at, at least; and 16 in every interval
  /// Where it can be done with at most twice the nodes, the step is a multiple of this (0: any step), so that it is
  /// written in few digits; mm or rad.
  double step_multiple = 0;
  /// Where a node has to be, mm or rad. The outer nodes then may lie outside, on straight continuations of the cells at
  /// the ends, where the functions are not asked; the step is a multiple of `step_multiple` in any case.
  std::optional<double> anchor;
  /// Where the functions may have kinks (kinks_of), mm or rad. Grids with nodes on all of them are tried too.
  std::vector<double> kinks;
};

/// Evenly spaced nodes and how well straight lines between them follow.
struct TableNodes {
  std::vector<double> positions;            ///< [n] mm or rad; one node if from = to
  std::vector<std::vector<double>> values;  ///< [functions][n]
  std::vector<double> error;                ///< [functions] largest difference found between the nodes
  bool within = true;                       ///< every error is within its tolerance
};

/// Few evenly spaced nodes (to three parts in a hundred the fewest) that keep straight lines within the tolerance, or
/// `most` of them.
///
/// Near a kink straight lines are off by as much as the kink is away from a node, so that grids in general come near
/// only with very many nodes; those on all kinks need no more than the function between them.
///
/// The difference is looked at in 16 places of every interval, and at no fewer than `places` in all, so that what is
/// narrower than an interval is seen too.
TableNodes choose_nodes(const SampledFunctions& functions, const NodeSpacing& spacing);

/// Nodes of the error motions of an axis that are straight-line tables.
std::vector<double> kinks_of(const ErrorSet& errors, std::size_t axis);

/// Exactly so many nodes; with an anchor, nodes as close as so many over the travel, or as `most` allows.
TableNodes nodes_at(const SampledFunctions& functions, const NodeSpacing& spacing, std::size_t count);

}  // namespace abbe
