#pragma once

#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"
#include "abbe/runtime/freeze.h"
#include "abbe/runtime/frozen_uncertainty.h"

namespace abbe {

/// Uncertainties of a compensation as its file has them, and how well they stand for those in between.
struct UncertaintyLattice {
  std::vector<FrozenUncertainty::Dimension> dimensions;  ///< empty: the errors have no uncertainties
  std::vector<double> values;                            ///< mm, the last dimension is the fastest
  double largest = 0, mean = 0;                          ///< mm, at the tried poses
  double interpolation = 0;                              ///< mm, largest difference of the lattice there
};

/// Standard uncertainty of the functional point's correction in the direction in which it is largest, mm: the root of
/// the largest eigenvalue of J C J' with J the derivative of the point by all parameters of the errors.
///
/// Tools lie along the tool direction of the machine; axes go from end to end of travel and map. Machines of more axes
/// than the lattice has dimensions leave out those nearest the workpiece, which stand in the middle of their travel.
/// Source: JCGM 102:2011, 6.2.
/// @param corners  values of given states (corners() of freeze_states.h), of which the largest uncertainty counts
UncertaintyLattice uncertainty_lattice(const Machine& machine, const ErrorSet& errors, const FreezeOptions& options,
                                       const std::vector<std::vector<double>>& corners);

}  // namespace abbe
