#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/geometry/surface/mesh_check.h"

namespace abbe {

/// A mesh file with what was counted in it.
struct CheckedMesh {
  MeshFile file;
  MeshCheck check;
  std::size_t repeated = 0;

  bool is_inside_out() const { return check.encloses_volume() && check.volume < 0; }
  /// Nothing is left out, and inside and outside are told apart wherever there is a surface.
  bool is_sound() const {
    return file.left_out.empty() && check.is_oriented() && check.branching_edges == 0 &&
           check.duplicate_triangles == 0 && !is_inside_out();
  }
};

/// A file of points with what was counted in it; lengths in mm.
struct CheckedCloud {
  PointCloudFile file;
  std::size_t repeated = 0;                ///< points at the place of another one
  Eigen::Vector3d lower, upper, centroid;  ///< of the points
};

CheckedMesh checked_mesh(MeshFile file);
CheckedCloud checked_cloud(PointCloudFile file);

}  // namespace abbe
