#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/geometry/surface/closest_point.h"
#include "abbe/verify/evaluations/exact_sum.h"
#include "abbe/verify/evaluations/fine_histogram.h"
#include "abbe/verify/parts/point_sample.h"
#include "abbe/verify/parts/surface_deviation.h"

namespace abbe {

/// Sums of the deviations of any number of points, from which their statistics follow. They are exact, so that nothing
/// depends on the blocks in which the points come, nor on threads.
struct DeviationTotals {
  std::uint64_t count = 0, within = 0;
  double minimum = 0, maximum = 0;
  ExactSum sum, squares;

  void add(double deviation_mm, const std::optional<DeviationTolerance>& tolerance);
  void add(const DeviationTotals& other);
  /// All of the statistics but the percentiles.
  DeviationStatistics statistics() const;
};

/// Deviations of the points of a scan from a surface in memory that does not grow with their number: what
/// surface_deviation() finds, with percentiles from a histogram, and a choice of the points.
class DeviationSums {
 public:
  /// @param options  its regions have to outlive the object
  explicit DeviationSums(const SurfaceDeviationOptions& options, std::size_t sample = PointSample::kDefault);

  /// Adds points that follow each other. @param first  number of the first one among the points of the scan
  /// @param points  [3, n] mm, frame of the part @param closest  [n] on the part
  void add(std::uint64_t first, const Eigen::Matrix3Xd& points, std::span<const SurfacePoint> closest, int threads);

  std::uint64_t points() const { return points_; }  ///< all that were added
  std::uint64_t beyond_border() const { return beyond_border_; }
  std::uint64_t too_far() const { return too_far_; }
  DeviationStatistics all() const;                   ///< percentiles within their bounds
  std::vector<DeviationStatistics> regions() const;  ///< without percentiles
  const FineHistogram& histogram() const { return histogram_; }
  const PointSample& sample() const { return sample_; }

  /// All of it as bytes, for the same program: to be added to sums of other points of the scan.
  /// @param known  a choice among other points, which has been added there before: what it does not keep is left out
  std::string state(const PointSample& known) const;
  /// @throws std::invalid_argument for bytes that are no state of sums with these options
  void add_state(std::string_view state);

 private:
  void add_regions(std::span<const SurfacePoint> closest, std::span<const std::uint32_t> classes, int threads);

  SurfaceDeviationOptions options_;
  std::uint64_t points_ = 0, beyond_border_ = 0, too_far_ = 0;
  DeviationTotals all_;
  std::vector<DeviationTotals> regions_;
  FineHistogram histogram_;
  PointSample sample_;
};

}  // namespace abbe
