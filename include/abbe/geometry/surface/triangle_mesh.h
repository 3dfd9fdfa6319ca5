#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace abbe {

/// Surface of triangles that share vertices.
///
/// A triangle counts its corners anticlockwise seen from outside, so that its normal (b - a) x (c - a) leaves the
/// material. Readers guarantee that every index is below the number of vertices and every coordinate is finite;
/// triangles without area may occur and count as the segment or the point that they are.
struct TriangleMesh {
  Eigen::Matrix3Xd vertices;                                  ///< [3, vertices] mm
  Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic> triangles;  ///< [3, triangles] columns of `vertices`

  Eigen::Index size() const { return triangles.cols(); }
  Eigen::Vector3d corner(Eigen::Index triangle, int which) const { return vertices.col(triangles(which, triangle)); }
};

}  // namespace abbe
