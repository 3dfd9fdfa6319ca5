#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace abbe {

/// Summary of a sample, in its own unit.
struct SampleStatistics {
  std::size_t count = 0;     ///< values used
  std::size_t excluded = 0;  ///< values left out (outside the measured range)
  double mean = 0;
  double rms = 0;        ///< root mean square about zero
  double deviation = 0;  ///< sample standard deviation about the mean, n - 1
  double minimum = 0;
  double maximum = 0;
  std::size_t maximum_at = 0;                    ///< index of the maximum in the sample
  double median = 0, p90 = 0, p95 = 0, p99 = 0;  ///< percentiles, see percentile()
};

/// @param covered  [values] or empty: values with 0 are left out
SampleStatistics sample_statistics(std::span<const double> values, std::span<const std::uint8_t> covered = {});

/// Exact percentile with linear interpolation between order statistics (Hyndman and Fan type 7, the default of R and
/// numpy).
/// @param fraction  0..1
/// @return 0 for an empty sample
double percentile(std::span<const double> values, double fraction);

/// Counts in equal classes; the last class includes its upper edge.
struct Histogram {
  double from = 0;
  double width = 0;  ///< of a class
  std::vector<std::size_t> counts;
  std::size_t below = 0, above = 0;  ///< values outside
};

/// Classes from `from` to `to`; give the same edges for "before" and "after" to compare them.
Histogram histogram(std::span<const double> values, double from, double to, std::size_t classes,
                    std::span<const std::uint8_t> covered = {});

}  // namespace abbe
