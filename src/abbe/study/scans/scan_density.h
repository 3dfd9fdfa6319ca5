#pragma once

// Internal to study: what some points of a scan tell of all, before all are compared.
#include <cstddef>
#include <stop_token>

#include "abbe/formats/shapes/point_cloud_blocks.h"
#include "abbe/geometry/surface/closest_point.h"
#include "abbe/study/scans/scan_deviations.h"

namespace abbe {

struct ScanDensity {
  std::size_t points = 0;  ///< of the scan, about
  double radius_mm = 0;    ///< radius_of_readings() of those that count, about; 0: none does
};

/// Compares at most kRadiusReadings of the points, about, from all of the file; of fewer, all. The same in every
/// process.
/// @throws InputError as PointCloudBlocks::read(); Stopped
ScanDensity scan_density(const ScanDeviationsRequest& request, const PointCloudBlocks& blocks,
                         const ClosestPointFinder& surface, const std::stop_token& stop);

}  // namespace abbe
