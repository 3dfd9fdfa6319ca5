#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "abbe/geometry/numbered_work.h"
#include "abbe/geometry/surface/closest_point.h"

namespace abbe {

/// Rough distances to a surface on a grid of points, for the many poses that a search of a start tries.
class DistanceGrid {
 public:
  /// @param low, high  corners of the part's box, mm
  /// @param margin     distances are known up to this one outside of the box, mm
  /// @param cells      along the longest side
  /// @param work       who computes them, for every process; its fingerprints do not know the surface
  DistanceGrid(const ClosestPointFinder& surface, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
               double margin, int cells, int threads, const WorkDriver& work = {});

  /// Distance from the nearest point of the grid, mm; off by at most half a diagonal of a cell. Infinite outside.
  float at(const Eigen::Vector3d& point) const {
    std::size_t index = 0;
    for (int k = 0; k < 3; ++k) {
      const double place = (point[k] - start_[k]) * inverse_step_ + 0.5;
      if (!(place >= 0 && place < size_[k])) return std::numeric_limits<float>::infinity();
      index = index * static_cast<std::size_t>(size_[k]) + static_cast<std::size_t>(place);
    }
    return distances_[index];
  }

 private:
  void share(const ClosestPointFinder& surface, const Eigen::Matrix3Xd& points, int threads, const WorkDriver& work);

  Eigen::Vector3d start_;
  double inverse_step_ = 1;
  Eigen::Vector3i size_;
  std::vector<float> distances_;
};

}  // namespace abbe
