#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>

#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// Where a ray meets a mesh first.
struct RayHit {
  double distance = 0;         ///< mm along the ray, from its origin
  std::uint32_t triangle = 0;  ///< of several as near: the one with the smallest number
  Eigen::Vector3d normal;      ///< unit normal of that triangle, out of the material
};

/// First meetings of rays with a triangle mesh.
///
/// A ray through an edge or a vertex that triangles share meets one of them: the edge functions of neighbours are
/// computed from the same numbers and differ in sign alone, and zero counts as inside. Triangles without area are met
/// by no ray. Sources: Woop, Benthin, Wald, J. Comput. Graph. Tech. 2 (2013) 65 (watertight test), here in double
/// precision; the tree is that of ClosestPointFinder.
class RayTracer {
 public:
  /// @param mesh     copied; at least one triangle; finite coordinates
  /// @param threads  0: all; the result does not depend on it
  explicit RayTracer(const TriangleMesh& mesh, int threads = 0);
  ~RayTracer();
  RayTracer(RayTracer&&) noexcept;
  RayTracer& operator=(RayTracer&&) noexcept;

  /// First meeting between two distances along the ray, whichever side of the surface is met.
  /// @param origin     mm, frame of the mesh, finite
  /// @param direction  unit vector
  /// @param from, to   mm, from < to; finite; may be negative
  std::optional<RayHit> first(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double from,
                              double to) const;

 private:
  struct Inside;
  std::unique_ptr<const Inside> inside_;
};

}  // namespace abbe
