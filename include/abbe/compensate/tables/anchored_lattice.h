#pragma once

#include <cstddef>
#include <vector>

#include "abbe/compensate/tables/anchored_nodes.h"
#include "abbe/compensate/tables/correction_lattice.h"

namespace abbe {

/// The same function inside the old ends, with outer nodes that lie further out: the cells at the ends continue in
/// straight lines to the first node outside, and the value stays constant beyond it.
/// @param positions  [inputs][nodes] with all the lattice's nodes but those at its ends; at least two old nodes each
CorrectionLattice continued_lattice(const CorrectionLattice& lattice,
                                    const std::vector<std::vector<double>>& positions);

struct AnchoredLatticeOptions {
  /// `most_per_axis` and `most_nodes` count nodes outside the travel too; three per input are taken in any case.
  LatticeOptions lattice;
  std::vector<double> anchor;    ///< [inputs] where a node has to be; mm or rad
  double step_multiple = 0.001;  ///< intervals are whole multiples of it, mm or rad
};

struct AnchoredLattice {
  BuiltLattice built;  ///< inside the travel, so that nothing is computed outside
  CorrectionLattice lattice;
  std::vector<AnchoredNodes> nodes;  ///< [inputs]
};

/// Lattice with a node at a given place along every input, for controls that count nodes from their reference position.
/// Where this makes the interpolation worse than the tolerance, closer nodes are tried.
AnchoredLattice build_anchored_lattice(const Machine& machine, const ErrorSet& errors,
                                       const AnchoredLatticeOptions& options);

}  // namespace abbe
