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
  /// The step is a multiple of this if that takes at most twice the nodes (0: any step), so that it can be written with
  /// few digits; mm or rad.
  double step_multiple = 0;
  /// Place that has to be a node, mm or rad. The outer nodes may then lie outside, on straight continuations of the end
  /// cells, where the functions are not evaluated. The step is a multiple of `step_multiple` in any case.
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

/// The fewest evenly spaced nodes (to three per cent) with which straight lines stay within the tolerance, or `most` of
/// them.
///
/// Near a kink, the error of straight lines grows with the distance of the kink from a node. Most grids therefore need
/// very many nodes; a grid with nodes on all kinks needs no more than the function between them.
///
/// The difference is looked at in 16 places of every interval, and at no fewer than `places` in all, so that what is
/// narrower than an interval is seen too.
TableNodes choose_nodes(const SampledFunctions& functions, const NodeSpacing& spacing);

/// Nodes of the error motions of an axis that are straight-line tables.
std::vector<double> kinks_of(const ErrorSet& errors, std::size_t axis);

/// Exactly this many nodes; with an anchor, nodes as close as this many over the travel, or as `most` allows.
TableNodes nodes_at(const SampledFunctions& functions, const NodeSpacing& spacing, std::size_t count);

}  // namespace abbe
