#pragma once

#include <Eigen/Core>

namespace abbe {

/// Points of a scan in the order in which they were taken, in one frame that the owner names.
struct PointCloud {
  Eigen::Matrix3Xd points;   ///< [3, n] mm
  Eigen::Matrix3Xd normals;  ///< [3, n] unit vectors out of the material, or [3, 0] where unknown

  Eigen::Index size() const { return points.cols(); }
  bool has_normals() const { return normals.cols() == points.cols() && normals.cols() > 0; }
};

}  // namespace abbe
