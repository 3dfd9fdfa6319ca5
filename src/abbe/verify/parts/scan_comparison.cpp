#include "abbe/verify/parts/scan_comparison.h"

namespace abbe {

ScanComparison compare_scan(const ClosestPointFinder& surface, const Eigen::Matrix3Xd& points,
                            const ScanComparisonOptions& options) {
  return compare_scan(surface.closest(points, options.threads, options.stop), points, options);
}

ScanComparison compare_scan(std::vector<SurfacePoint> closest, const Eigen::Matrix3Xd& points,
                            const ScanComparisonOptions& options) {
  ScanComparison result;
  result.faces = options.faces;
  SurfaceDeviationOptions deviation;
  deviation.tolerance = options.tolerance;
  deviation.largest_mm = options.largest_mm;
  deviation.region_of_triangle = result.faces.face_of_triangle;
  deviation.regions = result.faces.count();
  result.closest = std::move(closest);
  result.deviation = surface_deviation(result.closest, deviation);
  const std::size_t count = result.deviation.all.sample.count;
  result.counted_mm.reserve(count);
  result.counted_points.resize(3, static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < result.deviation.counted.size(); ++i) {
    if (result.deviation.counted[i] == 0) continue;
    result.counted_points.col(static_cast<Eigen::Index>(result.counted_mm.size())) =
        points.col(static_cast<Eigen::Index>(i));
    result.counted_mm.push_back(result.deviation.deviation_mm[i]);
  }
  return result;
}

}  // namespace abbe
