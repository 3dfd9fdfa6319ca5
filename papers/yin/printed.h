#pragma once

#include <Eigen/Core>

#include "abbe/identify/linkage/swing_head_linkage.h"

/// Matrices and formulas of Yin et al. (2021) as the paper has them, right or wrong. For comparison: nothing else uses
/// them.
namespace abbe::yin_printed {

/// (1) to (3) multiplied as (4) says: C2CS from LCS.
Eigen::Matrix4d chain(const SwingHeadLinkage& linkage, const SwingHeadCommand& command);
/// (5), its first three lines.
Eigen::Vector3d focus(const SwingHeadLinkage& linkage, const SwingHeadCommand& command);
/// (6), its last three lines: X, Y, Z for given A and C1.
void solve_linear(const SwingHeadLinkage& linkage, const Eigen::Vector3d& point, SwingHeadCommand& command);
/// (6).
SwingHeadCommand inverse(const SwingHeadLinkage& linkage, const Eigen::Vector3d& point, const Eigen::Vector3d& beam);

}  // namespace abbe::yin_printed
