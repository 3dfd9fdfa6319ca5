#pragma once

#include <Eigen/Core>
#include <optional>
#include <stop_token>
#include <vector>

#include "abbe/geometry/surface/closest_point.h"
#include "abbe/geometry/surface/surface_faces.h"
#include "abbe/verify/parts/surface_deviation.h"

namespace abbe {

struct ScanComparisonOptions {
  std::optional<DeviationTolerance> tolerance = std::nullopt;
  double largest_mm = 0;    ///< points farther away are left out; 0: all count
  SurfaceFaces faces = {};  ///< by which statistics are stated too; empty: none
  int threads = 0;          ///< 0: all; the result does not depend on it
  std::stop_token stop{};   ///< looked at before every block of points: throws Stopped
};

/// Points of a scan against the surface of its part.
struct ScanComparison {
  std::vector<SurfacePoint> closest;  ///< [points] on the part
  SurfaceDeviation deviation;         ///< of them, positive outside of the material; its regions are the faces
  SurfaceFaces faces;                 ///< as asked for
  Eigen::Matrix3Xd counted_points;    ///< [3, n] mm, those that count
  std::vector<double> counted_mm;     ///< [n] their deviations
};

/// Compares a scan with its part.
/// @param surface  of the part
/// @param points   [3, n] mm, frame of the part
/// @throws std::invalid_argument for faces that are not those of the part's triangles
ScanComparison compare_scan(const ClosestPointFinder& surface, const Eigen::Matrix3Xd& points,
                            const ScanComparisonOptions& options = {});
/// The same where the closest points are known. @param closest  [n]
ScanComparison compare_scan(std::vector<SurfacePoint> closest, const Eigen::Matrix3Xd& points,
                            const ScanComparisonOptions& options = {});

}  // namespace abbe
