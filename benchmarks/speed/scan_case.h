#pragma once

#include <Eigen/Core>
#include <chrono>

#include "abbe/geometry/rigid_transform.h"
#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe::benchmarks {

/// A closed, twisted blade of about a million triangles, 20 x 6 x 40 mm, and a scan of it.
struct ScanCase {
  TriangleMesh mesh;
  Eigen::Matrix3Xd surface;       ///< [3, n] on the triangles, in the order in which a line scanner passes, mm
  Eigen::Matrix3Xd normals;       ///< [3, n] of the triangles
  Eigen::Matrix3Xd scan;          ///< [3, n] surface with noise along the normal
  RigidTransform mesh_from_scan;  ///< true pose of `moved`
  Eigen::Matrix3Xd moved;         ///< [3, n] the scan in a frame of its own

  /// @param outliers  share of the points of `moved` that lie anywhere in the box
  ScanCase(std::size_t around, std::size_t along, Eigen::Index points, double noise_mm, double outliers);

  /// Largest displacement of a vertex between a pose that was found and the true one, mm.
  double error_mm(const RigidTransform& found) const;
};

inline double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// What one program needed, and how wrong it was.
struct Outcome {
  double prepare_s = 0, run_s = 0;
  double error_mm = 0;
  double total_s() const { return prepare_s + run_s; }
};

}  // namespace abbe::benchmarks
