#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Error motions of one axis over one set of functions, as a frozen file contains them; see frozen_layout.h.
struct FrozenFunctions {
  std::size_t axis = 0;
  int kind = 0;  ///< 0 Chebyshev, 1 Fourier, 2 piecewise cubic
  bool everywhere = false;
  double lowest = 0, highest = 0;
  double first = 0, second = 0;  ///< Chebyshev: from, to; Fourier, piecewise: period
  std::vector<double> nodes;
  std::vector<std::array<double, 6>> rows;  ///< coefficients of the six components
};

/// All error motions in the few kinds of functions that are evaluated in real time: polynomials become Chebyshev sums,
/// splines and tables cubic pieces, exactly (to rounding); terms over the same functions are added up. In the order of
/// axes.
/// @param problem  out: why a motion cannot be frozen; empty if all can
std::vector<FrozenFunctions> frozen_functions(const Machine& machine, const ErrorSet& errors, std::string& problem);

}  // namespace abbe
