#pragma once

// Internal to study: deviations of the points of a scan that is read in pieces.
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/geometry/surface/closest_point.h"
#include "abbe/geometry/surface/surface_faces.h"
#include "abbe/report/drawings/surface_picture.h"
#include "abbe/study/job_options.h"
#include "abbe/study/scans/scan_deviations.h"

namespace abbe {

/// Deviations of the points that count, mm, in the order of the scan.
struct CountedDeviations {
  PointCloudFile scan;     ///< without its points
  std::size_t points = 0;  ///< of the scan
  std::size_t beyond_border = 0, too_far = 0;
  std::vector<double> all;
  std::vector<std::vector<double>> faces;  ///< [faces] of the points nearest to each
  // If the request wants a page:
  Eigen::Matrix3Xd points_mm;  ///< [3, n]
  std::string csv;             ///< deviation.csv, unless the request takes it
  ColouredPart part;           ///< as the page shows it
  PlaceSums colours;           ///< of its places
  std::optional<DrawnReadings> drawn;
};

/// Compares the scan of a request with its part while it is read, piece by piece: pieces are numbered work, so several
/// processes also share the reading. The process that has compared a point writes its row of deviation.csv, and adds it
/// to the colours of the picture. For these, some points are compared before.
/// What is passed over: normals, and properties that are no coordinates.
/// @param job  progress: bytes that were compared
/// @returns nothing where the first one of several processes has the result
/// @throws InputError also for a file that PointCloudBlocks does not read, or that changes meanwhile; Stopped
std::optional<CountedDeviations> counted_deviations(const ScanDeviationsRequest& request, const PointCloudOptions& scan,
                                                    const ClosestPointFinder& surface, const SurfaceFaces& faces,
                                                    const JobOptions& job);

}  // namespace abbe
