#pragma once

#include <Eigen/Core>
#include <vector>

#include "abbe/geometry/closest_point.h"

namespace abbe {

/// Rough distances to a surface on a grid of points, for the many poses that a search of a start tries.
class DistanceGrid {
 public:
  /// @param low, high  corners of the part's box, mm
  /// @param margin     distances are known up to this one outside of the box, mm
  /// @param cells      along the longest side
  DistanceGrid(const ClosestPointFinder& surface, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
               double margin, int cells, int threads);

  /// Distance from the nearest point of the grid, mm; off by at most half a diagonal of a cell. Infinite outside.
  float at(const Eigen::Vector3d& point) const;

 private:
  Eigen::Vector3d start_;
  double inverse_step_ = 1;
  Eigen::Vector3i size_;
  std::vector<float> distances_;
};

}  // namespace abbe
