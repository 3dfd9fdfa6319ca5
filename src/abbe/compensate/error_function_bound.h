#pragma once

#include <span>

#include "abbe/errors/basis.h"

namespace abbe {

/// Proven bounds of a function of one axis position over an interval; mm or rad, per mm or rad of the axis.
struct FunctionBound {
  double value = 0;  ///< at least |f|
  double slope = 0;  ///< at least |f'|
  double bend = 0;   ///< at least |f''| where it exists
  double jumps = 0;  ///< at least the sum of |jump of f'| in [from, to): the kinks of linear tables

  void include(const FunctionBound& other);  ///< bounds of both; jumps: the sum
};

/// Bounds of an error motion as it is evaluated, over from <= q <= to (extrapolation included).
///
/// Polynomials: their Taylor polynomial about the middle of the interval, which is finite. Fourier: the same with the
/// remainder of the fifth derivative. Splines and tables: piece by piece. All take the absolute values of terms, so
/// they are as tight as the interval is short against the function's shortest wave. Derivation: docs/programs.md.
FunctionBound bound_function(const Basis& basis, std::span<const double> coefficients, double from, double to);

}  // namespace abbe
