#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace abbe {

enum class BasisKind { monomial, legendre, chebyshev, fourier, bspline, table_linear, table_monotone };

/// Basis functions of one axis position; an error motion is the sum of coefficients times these.
///
/// With s = (2 q - from - to) / (to - from), so that s runs over [-1, 1]:
///   monomial   1, s, s^2, ..., s^order
///   legendre   P_0(s) ... P_order(s)
///   chebyshev  T_0(s) ... T_order(s)
///   fourier    1, cos(t), sin(t), cos(2 t), ..., sin(order t), with t = 2 pi q / period
///   bspline    uniform cubic B-splines over `order` intervals of [from, to]; order + 3 functions
///              (periodic: `order` functions, the intervals close to a ring)
///   table_linear    hat functions at `nodes` (periodic: the last node joins the first after `period`)
///   table_monotone  piecewise cubic Hermite through the node values with Fritsch-Butland slopes
///                   (SIAM J. Sci. Stat. Comput. 5 (1984) 300): no overshoot. The values at a position depend on
///                   the coefficients, but f = sum of values times coefficients still holds because f is
///                   homogeneous of degree one in the node values, and the values are df/d(coefficient).
/// Positions in mm or rad; every function value is dimensionless, so a coefficient has the unit of the error motion.
struct Basis {
  BasisKind kind = BasisKind::legendre;
  int order = 0;                ///< degree, number of harmonics or number of intervals; tables: unused
  double from = 0;              ///< first valid position, mm or rad
  double to = 0;                ///< last valid position
  double period = 0;            ///< fourier; periodic bspline and table_linear; mm or rad
  bool periodic = false;        ///< bspline, table_linear: wraps around with `period`; valid everywhere
  std::vector<double> nodes{};  ///< tables: increasing positions, first = from, last = to

  std::size_t size() const;

  /// False where an evaluation would be an extrapolation. Fourier over a whole period and periodic bases are valid
  /// everywhere; all others from `from` to `to` with 1e-9 of the range to spare.
  bool covers(double position) const;

  /// Basis functions at one position.
  /// @param coefficients  [size()]; read only by table_monotone
  /// @param out           [size()], written
  void values(double position, std::span<const double> coefficients, std::span<double> out) const;

  /// Sum of coefficients times basis functions.
  double evaluate(double position, std::span<const double> coefficients) const;

  /// d(evaluate)/d(position), per mm or rad.
  double slope(double position, std::span<const double> coefficients) const;

  /// Short name of one function for parameter names: "P2", "T3", "s^2", "cos1", "sin2", "B4", "@120" (node in mm or
  /// deg).
  std::string function_name(std::size_t index, bool rotary) const;

  bool operator==(const Basis&) const = default;
};

/// Name as written in files: "legendre", "table-linear", ...
const char* basis_kind_name(BasisKind kind);

}  // namespace abbe
