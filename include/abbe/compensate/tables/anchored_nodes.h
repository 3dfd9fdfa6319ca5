#pragma once

#include <cstddef>
#include <vector>

namespace abbe {

/// Evenly spaced nodes, one of them at a given place, that cover a travel; positions and lengths in mm or rad.
struct AnchoredNodes {
  double interval = 0;
  std::size_t anchor = 0;         ///< index of the node at the given place
  std::vector<double> positions;  ///< the first and the last may lie outside the travel
  std::vector<double> inside;     ///< the ends of the travel and the nodes between them
};
/// @param interval  above zero
AnchoredNodes anchored_nodes(double from, double to, double anchor, double interval);

/// Nodes at the requested interval, or as close as the number of nodes allows. An anchor between the ends needs three
/// nodes, even if fewer are requested.
/// @param multiple  the interval is rounded up to a whole number of these; 0: it is not
AnchoredNodes anchored_nodes_within(double from, double to, double anchor, double interval, double multiple,
                                    std::size_t most);

/// Interval and share of the way through it; below 0 and above 1 outside.
struct Continuation {
  std::size_t index = 0;
  double share = 0;
};
/// Positions of places in a grid whose cells at the ends continue in straight lines to the first place outside; places
/// further out get the position of that one.
/// @param from  at least two nodes, ascending
/// @param to    ascending
std::vector<Continuation> continuations(const std::vector<double>& from, const std::vector<double>& to);

}  // namespace abbe
