#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "abbe/verify/parts/deviation_block.h"

namespace abbe {

/// Derivatives of a block's deviations by some parameters, in parts of at most ChainPlan::kBlockSize poses.
///
/// @param block       evaluated by `model`
/// @param parameters  indices into ErrorSet::parameters(), [n]
/// @param rows        6: displacement and rotation of the functional point; 3: displacement alone
/// @param visit       called with the first pose of a part, its number of poses m, and the derivatives [rows * m, n]:
///                    row c * m + k is component c of the part's pose k, mm or rad
void for_each_deviation_jacobian(const DeviationModel& model, const DeviationBlock& block,
                                 const std::vector<std::size_t>& parameters, Eigen::Index rows,
                                 const std::function<void(std::size_t, Eigen::Index, const Eigen::MatrixXd&)>& visit);

/// Displacement of a point by a small motion (translation mm, rotation about the origin rad).
inline Eigen::Matrix<double, 3, 6> displacement_by_motion(double x, double y, double z) {
  Eigen::Matrix<double, 3, 6> b;
  b << 1, 0, 0, 0, z, -y, 0, 1, 0, -z, 0, x, 0, 0, 1, y, -x, 0;
  return b;
}

}  // namespace abbe
