#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <vector>

#include "abbe/geometry/stopped.h"
#include "abbe/geometry/surface/triangle_mesh.h"

namespace abbe {

/// Part of a triangle on which a closest point lies.
enum class SurfaceFeature : std::uint8_t { face, edge, vertex };

/// Closest point of a surface.
struct SurfacePoint {
  Eigen::Vector3d point;       ///< on the surface, mm, frame of the mesh
  double distance = 0;         ///< mm; positive on the side to which the normals point: outside of the material
  Eigen::Vector3d normal;      ///< unit normal of the face, or angle-weighted normal of the edge or vertex; zero if no
                               ///< triangle with area is there
  std::uint32_t triangle = 0;  ///< of several as near: the one with the smallest number
  SurfaceFeature feature = SurfaceFeature::face;
  bool on_border = false;  ///< on the edge of an open mesh, beyond which the surface may have gone on
};

/// Exact closest points of a triangle mesh, for many points.
///
/// Distances are exact to a few roundings of the largest coordinate difference between point and mesh (tested: 1e-14 of
/// it), wherever the mesh stands. Vertices at the same place count as one. The sign is that of the angle-weighted
/// normal of the nearest face, edge or vertex, which is right everywhere for a closed mesh whose triangles are oriented
/// outwards. For an open mesh it is the side of the sheet that the normal at the closest point sees; where the closest
/// point is `on_border` the sign is no more than that. A triangle without area counts for distances and takes the mean
/// normal of its neighbours for signs.
/// Sources: Baerentzen and Aanaes, IEEE Trans. Vis. Comput. Graph. 11 (2005) 243 (sign); docs/registration.md.
class ClosestPointFinder {
 public:
  /// The mesh is copied in the form needed; at most 2^28 triangles.
  /// @param mesh     at least one triangle; finite coordinates
  /// @param threads  0: all; the result does not depend on it
  explicit ClosestPointFinder(const TriangleMesh& mesh, int threads = 0);
  ~ClosestPointFinder();
  ClosestPointFinder(ClosestPointFinder&&) noexcept;
  ClosestPointFinder& operator=(ClosestPointFinder&&) noexcept;

  /// @param points  [3, n] mm, finite, frame of the mesh, in any order: more than kBlock of them are searched in an
  ///                order of their own, in which neighbours follow each other
  /// @param stop    looked at before every block
  /// @return [n]
  /// @throws Stopped
  std::vector<SurfacePoint> closest(const Eigen::Ref<const Eigen::Matrix3Xd>& points, int threads = 0,
                                    const std::stop_token& stop = {}) const;
  SurfacePoint closest_to(const Eigen::Vector3d& point) const;

  /// Same points, distances only. @return [n] mm, signed
  Eigen::VectorXd signed_distances(const Eigen::Ref<const Eigen::Matrix3Xd>& points, int threads = 0) const;

  /// Closest points of a few thousand points on the calling thread, for callers that make blocks of their own; fastest
  /// where each point is near the one before (`hilbert_order`). The result does not depend on the order.
  /// @param found  [points] filled
  /// @param hints  null, or [points] kNoHint at first: remembers where the points were found, which makes the next
  ///               search of the same points, moved a little, faster; the result does not depend on it
  void closest_block(const Eigen::Ref<const Eigen::Matrix3Xd>& points, SurfacePoint* found,
                     std::uint32_t* hints = nullptr) const;
  static constexpr std::uint32_t kNoHint = 0xffffffffu;

  /// Points that are treated together.
  static constexpr Eigen::Index kBlock = 2048;

 private:
  struct Inside;
  std::unique_ptr<const Inside> inside_;
};

}  // namespace abbe
