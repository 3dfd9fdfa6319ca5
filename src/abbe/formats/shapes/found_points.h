#pragma once

// Internal to formats: points as readers find them whose files may have points without coordinates.
#include <Eigen/Core>
#include <cstddef>

#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/formats/shapes/point_normals.h"

namespace abbe {

/// Columns [0, found) of the arrays are points of the file; the reader fills more than it keeps.
class FoundPoints {
 public:
  /// @param most  points of the file, for which it has room
  FoundPoints(Eigen::Index most, bool normals) : has_normals_(normals) {
    cloud_.points.resize(3, most);
    cloud_.normals.resize(3, normals ? most : 0);
  }

  Eigen::Matrix3Xd& points() { return cloud_.points; }
  Eigen::Matrix3Xd& normals() { return cloud_.normals; }

  /// Keeps a point: the next column, which may not come after that of the point in the arrays.
  void keep(const Eigen::Vector3d& point) { cloud_.points.col(kept_++) = point; }
  void keep(const Eigen::Vector3d& point, Eigen::Vector3d normal) {
    if (!make_unit(normal)) ++without_normal_;
    cloud_.normals.col(kept_) = normal;
    keep(point);
  }
  void leave_out_not_finite() { ++not_finite_; }
  void leave_out_invalid() { ++invalid_; }

  Eigen::Index kept() const { return kept_; }
  /// Moves the cloud into the result, with notes of what is not in it. @throws InputError if no point is left
  void finish(const std::string& file, PointCloudFile& result);

 private:
  PointCloud cloud_;
  bool has_normals_;
  Eigen::Index kept_ = 0;
  std::size_t not_finite_ = 0;
  std::size_t invalid_ = 0;
  std::size_t without_normal_ = 0;
};

}  // namespace abbe
