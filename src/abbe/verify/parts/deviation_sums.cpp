#include "abbe/verify/parts/deviation_sums.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/geometry/parallel_blocks.h"

namespace abbe {
namespace {

/// In place of the class of a point that does not count.
constexpr std::uint32_t kBeyondBorder = 0xffffffffU, kTooFar = 0xfffffffeU;
constexpr std::size_t kPointsTogether = 16384;
/// Parts of the regions that are added at a time.
constexpr std::size_t kRegionParts = 16;

}  // namespace

void DeviationTotals::add(double deviation_mm, const std::optional<DeviationTolerance>& tolerance) {
  minimum = count == 0 ? deviation_mm : std::min(minimum, deviation_mm);
  maximum = count == 0 ? deviation_mm : std::max(maximum, deviation_mm);
  ++count;
  if (tolerance && deviation_mm >= tolerance->lower_mm && deviation_mm <= tolerance->upper_mm) ++within;
  sum.add(deviation_mm);
  squares.add_square(deviation_mm);
}

void DeviationTotals::add(const DeviationTotals& other) {
  if (other.count == 0) return;
  minimum = count == 0 ? other.minimum : std::min(minimum, other.minimum);
  maximum = count == 0 ? other.maximum : std::max(maximum, other.maximum);
  count += other.count;
  within += other.within;
  sum.add(other.sum);
  squares.add(other.squares);
}

DeviationStatistics DeviationTotals::statistics() const {
  DeviationStatistics result;
  result.sample.count = count;
  if (count == 0) return result;
  const auto n = static_cast<long double>(count);
  const long double total = sum.value(), square_total = squares.value();
  const long double spread = std::max(0.0L, square_total - total * (total / n));
  result.sample.mean = static_cast<double>(total / n);
  result.sample.rms = static_cast<double>(std::sqrt(square_total / n));
  result.sample.deviation = count > 1 ? static_cast<double>(std::sqrt(spread / (n - 1))) : 0;
  result.rms_about_mean = static_cast<double>(std::sqrt(spread / n));
  result.sample.minimum = minimum;
  result.sample.maximum = maximum;
  result.within = static_cast<double>(within) / static_cast<double>(count);
  return result;
}

DeviationSums::DeviationSums(const SurfaceDeviationOptions& options, std::size_t sample)
    : options_(options), regions_(options.regions), sample_(sample) {}

void DeviationSums::add(std::uint64_t first, const Eigen::Matrix3Xd& points, std::span<const SurfacePoint> closest,
                        int threads) {
  std::vector<std::uint32_t> classes(closest.size());
  const std::size_t blocks = (closest.size() + kPointsTogether - 1) / kPointsTogether;
  std::vector<DeviationTotals> totals(blocks);
  for_each_block(blocks, threads, [&](std::size_t block) {
    for (std::size_t i = block * kPointsTogether; i < std::min(closest.size(), (block + 1) * kPointsTogether); ++i) {
      const SurfacePoint& found = closest[i];
      const bool far = options_.largest_mm > 0 && !(std::abs(found.distance) <= options_.largest_mm);
      classes[i] = found.on_border ? kBeyondBorder : far ? kTooFar : FineHistogram::class_of(found.distance);
      if (!found.on_border && !far) totals[block].add(found.distance, options_.tolerance);
    }
  });
  for (const DeviationTotals& block : totals) all_.add(block);
  for (std::size_t i = 0; i < closest.size(); ++i) {
    if (classes[i] == kBeyondBorder) {
      ++beyond_border_;
    } else if (classes[i] == kTooFar) {
      ++too_far_;
    } else {
      histogram_.add(classes[i]);
      if (!sample_.wants(first + i, closest[i].distance)) continue;
      sample_.add({first + i, points.col(static_cast<Eigen::Index>(i)), closest[i].distance});
    }
  }
  if (!regions_.empty()) add_regions(closest, classes, threads);
  points_ += closest.size();
}

void DeviationSums::add_regions(std::span<const SurfacePoint> closest, std::span<const std::uint32_t> classes,
                                int threads) {
  for_each_block(kRegionParts, threads, [&](std::size_t part) {
    for (std::size_t i = 0; i < closest.size(); ++i) {
      if (classes[i] == kBeyondBorder || classes[i] == kTooFar) continue;
      const std::uint32_t triangle = closest[i].triangle;
      if (triangle >= options_.region_of_triangle.size() || options_.region_of_triangle[triangle] >= regions_.size()) {
        throw std::invalid_argument("a triangle belongs to a region that does not exist");
      }
      const std::uint32_t region = options_.region_of_triangle[triangle];
      if (region % kRegionParts == part) regions_[region].add(closest[i].distance, options_.tolerance);
    }
  });
}

DeviationStatistics DeviationSums::all() const {
  DeviationStatistics result = all_.statistics();
  const auto within_ends = [&](double fraction) {
    return std::clamp(histogram_.percentile(fraction).value, all_.minimum, all_.maximum);
  };
  result.sample.median = within_ends(0.5);
  result.sample.p90 = within_ends(0.9);
  result.sample.p95 = within_ends(0.95);
  result.sample.p99 = within_ends(0.99);
  result.p5 = within_ends(0.05);
  result.p25 = within_ends(0.25);
  result.p75 = within_ends(0.75);
  return result;
}

std::vector<DeviationStatistics> DeviationSums::regions() const {
  std::vector<DeviationStatistics> result;
  for (const DeviationTotals& region : regions_) result.push_back(region.statistics());
  return result;
}

}  // namespace abbe
