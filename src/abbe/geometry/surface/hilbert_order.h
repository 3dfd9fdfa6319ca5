#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace abbe {

/// Numbers of the points in the order in which a Hilbert curve through a box passes them: neighbours in this order are
/// neighbours in space.
///
/// The curve passes 1024 cells along each axis; points in the same cell keep their order, points outside of the box
/// count for the cell nearest to them. The order does not depend on the number of threads.
/// @param points     [3, n] finite, n < 2^32
/// @param low, high  corners of the box, in the unit and frame of the points
/// @return [n]
/// Source: J. Skilling, AIP Conf. Proc. 707 (2004) 381.
std::vector<std::uint32_t> hilbert_order(const Eigen::Ref<const Eigen::Matrix3Xd>& points, const Eigen::Vector3d& low,
                                         const Eigen::Vector3d& high, int threads);

}  // namespace abbe
