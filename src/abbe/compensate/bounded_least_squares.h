#pragma once

#include <Eigen/Core>

namespace abbe {

/// Up to three unknowns and three equations, on the stack.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;

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

}  // namespace abbe
