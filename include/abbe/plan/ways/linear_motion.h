#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "abbe/machine/machine.h"

namespace abbe {

/// Commands at which the tool stands elsewhere over the table, without turning: only linear axes move, with the least
/// sum of squares where there are several ways. Travel is not looked at.
/// @param pose          [axes] mm or rad
/// @param displacement  mm, of the tool over the workpiece, in axes parallel to the machine's
/// @returns nothing where the linear axes cannot do that; axes that are positioned beforehand stay
std::optional<std::vector<double>> moved_linearly(const Machine& machine, const std::vector<double>& pose,
                                                  const Eigen::Vector3d& displacement);

}  // namespace abbe
