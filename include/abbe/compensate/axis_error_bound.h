#pragma once

#include <cstddef>
#include <vector>

#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Proven bounds of the error motions of one axis, E = [Rz(EC) Ry(EB) Rx(EA) | (EX, EY, EZ)], over an interval of its
/// positions: norms of vectors and matrices, derivatives by the axis position in mm or rad.
struct AxisErrorBound {
  double shift = 0;        ///< of (EX, EY, EZ), mm
  double shift_slope = 0;  ///< of its first derivative
  double shift_bend = 0;   ///< of its second derivative
  double shift_jumps = 0;  ///< sum of the jumps of the first derivative
  double turn = 0;         ///< of rotation - identity, rad
  double turn_slope = 0, turn_bend = 0, turn_jumps = 0;

  void include(const AxisErrorBound& other);  ///< bounds of both; jumps: the sum
};

/// Bounds of one axis, looked up in cells over its travel.
class AxisErrorCells {
 public:
  /// @param state  of the terms that are bounded, without its factor; kNoState: those without a state
  AxisErrorCells(const Machine& machine, const ErrorSet& errors, std::size_t axis, std::size_t state = kNoState);

  /// Bounds over from <= q <= to. Where the interval leaves the cells they are worked out anew, which is slow.
  AxisErrorBound over(double from, double to) const;

  static constexpr std::size_t kCells = 256;

 private:
  AxisErrorBound bound(double from, double to) const;
  AxisErrorBound over_cells(std::size_t begin, std::size_t end) const;

  std::vector<ErrorMotion> motions_;
  double period_ = 0;  ///< 0: not periodic
  double first_ = 0, width_ = 1;
  std::vector<std::vector<AxisErrorBound>> levels_;  ///< level k: maxima over 2^k cells from each one on
  std::vector<double> shift_jumps_, turn_jumps_;     ///< [cells + 1] sums of all cells before
};

}  // namespace abbe
