#pragma once

#include <Eigen/Core>

#include "abbe/machine/machine.h"

namespace abbe {

/// Up to three unknowns and three equations, on the stack.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;
/// Up to six equations, an unknown for every axis.
using ArmMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxAxes, kMaxAxes>;
using ArmVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxAxes, 1>;

/// A vector y with |y| <= largest that makes |a y - b| small and changes continuously with a and b.
///
/// With a = U S V', y = V diag(s / max(s^2, t^2)) U' b and t = |b| / largest: the least-squares solution where no
/// singular value is below t, and of several the shortest. Below, y follows the singular value to zero instead of
/// standing at the bound: there a solution of least residual would go from one end of the ball to the other while s
/// passes zero. The price is a residual larger by up to 0.39 |b| than the least one in the ball.
/// @param a        [equations, unknowns]
/// @param b        [equations]
/// @param bounded  out: true if a singular value was below t
SmallVector bounded_least_squares(const SmallMatrix& a, const SmallVector& b, double largest, bool& bounded);

/// Two such problems for the same unknowns, the first of which comes first: y is the sum of its solution, which is at
/// right angles to all that leaves the first three equations alone, and of what makes the others small among the rest.
/// Together they are no longer than `largest`.
///
/// @param a        [3 to 6 equations, unknowns], the first three of the first problem
/// @param b        [3 to 6]
/// @param first    out: true if the solution of the first problem was bounded
/// @param bounded  out: true if that of the second one was
ArmVector bounded_in_order(const ArmMatrix& a, const ArmVector& b, double largest, bool& first, bool& bounded);

}  // namespace abbe
