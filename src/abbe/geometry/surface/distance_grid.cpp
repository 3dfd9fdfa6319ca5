#include "abbe/geometry/surface/distance_grid.h"

#include <cmath>

namespace abbe {

DistanceGrid::DistanceGrid(const ClosestPointFinder& surface, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                           double margin, int cells, int threads) {
  const Eigen::Vector3d extent = (high - low).array() + 2 * margin;
  const double step = extent.maxCoeff() / cells;
  inverse_step_ = 1 / step;
  start_ = low.array() - margin;
  for (int k = 0; k < 3; ++k) size_[k] = static_cast<int>(std::ceil(extent[k] * inverse_step_)) + 1;
  Eigen::Matrix3Xd points(3, Eigen::Index{size_[0]} * size_[1] * size_[2]);
  Eigen::Index next = 0;
  for (int x = 0; x < size_[0]; ++x) {
    for (int y = 0; y < size_[1]; ++y) {
      for (int z = 0; z < size_[2]; ++z) points.col(next++) = start_ + step * Eigen::Vector3d(x, y, z);
    }
  }
  const Eigen::VectorXd distances = surface.signed_distances(points, threads);
  distances_.reserve(static_cast<std::size_t>(distances.size()));
  for (const double d : distances) distances_.push_back(static_cast<float>(std::abs(d)));
}

}  // namespace abbe
