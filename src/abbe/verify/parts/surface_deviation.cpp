#include "abbe/verify/parts/surface_deviation.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "abbe/verify/evaluations/values_at_places.h"
#include "abbe/verify/parts/deviation_statistics.h"

namespace abbe {
DeviationStatistics deviation_statistics(std::span<const double> values,
                                         const std::optional<DeviationTolerance>& tolerance) {
  DeviationStatistics result;
  constexpr std::array<double, 3> kFractions = {0.05, 0.25, 0.75};
  std::array<double, 3> percentiles{};
  result.sample = sample_statistics(values, kFractions, percentiles);
  if (values.empty()) return result;
  double sum = 0;
  std::size_t within = 0;
  for (const double value : values) {
    sum += (value - result.sample.mean) * (value - result.sample.mean);
    if (tolerance && value >= tolerance->lower_mm && value <= tolerance->upper_mm) ++within;
  }
  const double count = static_cast<double>(values.size());
  result.rms_about_mean = std::sqrt(sum / count);
  result.within = static_cast<double>(within) / count;
  result.p5 = percentiles[0];
  result.p25 = percentiles[1];
  result.p75 = percentiles[2];
  return result;
}

SurfaceDeviation surface_deviation(std::span<const SurfacePoint> closest, const SurfaceDeviationOptions& options) {
  SurfaceDeviation result;
  result.deviation_mm.reserve(closest.size());
  result.counted.reserve(closest.size());
  std::vector<double> all;
  std::vector<std::vector<double>> regions(options.regions);
  for (const SurfacePoint& point : closest) {
    const bool far = options.largest_mm > 0 && !(std::abs(point.distance) <= options.largest_mm);
    if (point.on_border) {
      ++result.beyond_border;
    } else if (far) {
      ++result.too_far;
    }
    const bool counts = !point.on_border && !far;
    result.deviation_mm.push_back(point.distance);
    result.counted.push_back(counts ? 1 : 0);
    if (!counts) continue;
    all.push_back(point.distance);
    if (options.regions == 0) continue;
    if (point.triangle >= options.region_of_triangle.size() ||
        options.region_of_triangle[point.triangle] >= options.regions) {
      throw std::invalid_argument("a triangle belongs to a region that does not exist");
    }
    regions[options.region_of_triangle[point.triangle]].push_back(point.distance);
  }
  result.all = deviation_statistics(all, options.tolerance);
  for (const std::vector<double>& region : regions)
    result.regions.push_back(deviation_statistics(region, options.tolerance));
  return result;
}

}  // namespace abbe
