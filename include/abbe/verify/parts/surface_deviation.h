#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "abbe/geometry/surface/closest_point.h"
#include "abbe/verify/evaluations/statistics.h"

namespace abbe {

/// Where a deviation is allowed to lie, mm, both ends included.
struct DeviationTolerance {
  double lower_mm = 0, upper_mm = 0;
};

/// Signed deviations of points from a surface, mm, positive outside of the material.
struct DeviationStatistics {
  SampleStatistics sample;    ///< rms about zero; `deviation` is the standard deviation about the mean; percentiles of
                              ///< the signed values
  double rms_about_mean = 0;  ///< root mean square about the mean, divided by n, mm
  double p5 = 0, p25 = 0, p75 = 0;  ///< further percentiles, mm
  double within = 0;                ///< share of the points within the tolerance, 0 .. 1; 0 without one
};

struct SurfaceDeviation {
  std::vector<double> deviation_mm;   ///< [points]
  std::vector<std::uint8_t> counted;  ///< [points] 0: nearest to the border of an open mesh, or too far away
  DeviationStatistics all;
  std::vector<DeviationStatistics> regions;  ///< [regions]
  std::size_t beyond_border = 0, too_far = 0;
};

struct SurfaceDeviationOptions {
  std::optional<DeviationTolerance> tolerance = std::nullopt;
  /// Points farther away are no measurement of this surface and left out, mm; 0: all count.
  double largest_mm = 0;
  /// [triangles] number of the region of a triangle, or empty: no regions.
  std::span<const std::uint32_t> region_of_triangle = {};
  std::size_t regions = 0;
};

/// @param closest  [points] as ClosestPointFinder gives them
/// @throws std::invalid_argument if a triangle has a region that does not exist
SurfaceDeviation surface_deviation(std::span<const SurfacePoint> closest, const SurfaceDeviationOptions& options = {});

}  // namespace abbe
