#pragma once

// The extent of points.
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace abbe {

/// Smallest box with edges along the axes that contains the points, in their unit; empty if there are none. Column by
/// column, as they lie in memory: rowwise().minCoeff() of many points takes several times as long.
inline Eigen::AlignedBox3d bounding_box(const Eigen::Matrix3Xd& points) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index i = 0; i < points.cols(); ++i) box.extend(points.col(i));
  return box;
}

}  // namespace abbe
