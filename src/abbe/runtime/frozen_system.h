#pragma once

#include <array>

#include "abbe/runtime/frozen_pose.h"

namespace abbe {

/// Turns y of up to two rotary axes that take an orientation error c, as bounded_least_squares() gives them: exact
/// where the axes are independent (more so than the errors change the derivative), never longer than `largest`, and
/// going to zero with the singular value. Written on the normal equations, whose loss of digits the iterations around
/// it make good.
class TurnSystem {
 public:
  /// @param across  parts of the axes' directions at right angles to the tool, [count]
  TurnSystem(const abbe_runtime& machine, const NominalView& view);

  std::array<double, 2> solve(const Triple& c, double largest, bool& bounded) const;
  /// What turns y do.
  Triple of(const std::array<double, 2>& y) const;

 private:
  std::size_t count_ = 0;
  double least_ = 0;  // singular value that counts
  std::array<Triple, 2> across_{};
  double first_ = 0, mixed_ = 0, second_ = 0;  // of the matrix of products
  double area_ = 0, norm_ = 0;
};

/// Shifts z of up to three axes that take what is missing of the point; the same rule.
class ReachSystem {
 public:
  ReachSystem(const abbe_runtime& machine, const NominalView& view, const Triple& goal);

  Triple solve(const Triple& rest, double largest, bool& bounded) const;
  Triple of(const Triple& z) const { return z.x * column_[0] + z.y * column_[1] + z.z * column_[2]; }

 private:
  Triple solve_generally(const Triple& rest, double bound, bool& bounded) const;

  std::size_t count_ = 0;
  double least_ = 0;  // singular value that counts
  std::array<Triple, 3> column_{};
  std::array<Triple, 3> row_{};  // of the inverse times the determinant
  double determinant_ = 0, square_ = 0, norm_ = 0;
};

}  // namespace abbe
