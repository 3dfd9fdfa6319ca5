#pragma once

#include <vector>

#include "scan_case.h"

namespace abbe::benchmarks {

/// Open3D: signed distances by its ray casting scene (Embree, single precision).
/// @param distances  filled
Outcome open3d_distances(const TriangleMesh& mesh, const Eigen::Matrix3Xd& points, std::vector<double>* distances);

/// Open3D: point-to-plane ICP with Tukey's weights on the vertices of the mesh with their normals.
/// @param reach_mm  farthest correspondence
Outcome open3d_registration(const ScanCase& data, double reach_mm);

/// Embree: its tree in single precision, by its point query, whose callback measures triangles in double precision. All
/// distances without sign.
Outcome embree_distances(const TriangleMesh& mesh, const Eigen::Matrix3Xd& points, std::vector<double>* distances);

/// The same with what this project does too: the points along a Hilbert curve, each starting from the triangle of the
/// one before.
Outcome embree_sorted_distances(const TriangleMesh& mesh, const Eigen::Matrix3Xd& points,
                                std::vector<double>* distances);

/// PCL: distance to the nearest vertex, for it has no closest point of triangles.
Outcome pcl_distances(const TriangleMesh& mesh, const Eigen::Matrix3Xd& points, std::vector<double>* distances);

/// PCL: ICP with normals (point to plane) on the vertices of the mesh.
Outcome pcl_registration(const ScanCase& data, double reach_mm);

}  // namespace abbe::benchmarks
