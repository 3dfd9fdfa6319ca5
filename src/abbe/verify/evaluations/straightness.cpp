#include "abbe/verify/evaluations/straightness.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace abbe {
namespace {

/// A position with the readings that lie highest and lowest there.
struct Station {
  double position = 0;
  double low = 0, high = 0;
};

/// Stations in ascending order; positions nearer than kSamePosition are one.
std::vector<Station> stations_of(std::span<const double> positions, std::span<const double> heights) {
  std::vector<std::size_t> order(positions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return positions[a] < positions[b]; });
  std::vector<Station> stations;
  for (const std::size_t i : order) {
    if (stations.empty() || positions[i] - stations.back().position >= kSamePosition) {
      stations.push_back({positions[i], heights[i], heights[i]});
    } else {
      stations.back().low = std::min(stations.back().low, heights[i]);
      stations.back().high = std::max(stations.back().high, heights[i]);
    }
  }
  return stations;
}

struct Corner {
  double position = 0, height = 0;
};

double slope_between(const Corner& a, const Corner& b) { return (b.height - a.height) / (b.position - a.position); }

/// Upper (side = 1) or lower (side = -1) convex hull from left to right.
std::vector<Corner> hull_of(const std::vector<Station>& stations, double side) {
  std::vector<Corner> hull;
  for (const Station& station : stations) {
    const Corner next{station.position, side > 0 ? station.high : station.low};
    while (hull.size() >= 2) {
      const Corner &a = hull[hull.size() - 2], &b = hull.back();
      const double turn =
          (b.position - a.position) * (next.height - a.height) - (next.position - a.position) * (b.height - a.height);
      if (side * turn < 0) break;
      hull.pop_back();
    }
    hull.push_back(next);
  }
  return hull;
}

/// The narrowest zone: its slope, and what the uncertainties need.
struct NarrowestZone {
  double slope = 0;
  double edge_length = 0;  ///< distance of the two points that carry the slope
  double share = 0;        ///< place of the opposite point between them, 0..1
  double slope_range = 0;  ///< length of the range of slopes with the same width
};

NarrowestZone narrowest_zone(const std::vector<Station>& stations) {
  const std::vector<Corner> upper = hull_of(stations, 1), lower = hull_of(stations, -1);
  // With the slope growing from minus infinity the highest point of y - s x walks the upper hull from right to left and
  // the lowest one the lower hull from left to right; the derivative of the width is lowest.x - highest.x.
  std::size_t high = upper.size() - 1, low = 0;
  const auto next_slope = [&](bool& moves_high) {
    const bool high_left = high > 0, low_left = low + 1 < lower.size();
    const double of_high = high_left ? slope_between(upper[high - 1], upper[high]) : 0;
    const double of_low = low_left ? slope_between(lower[low], lower[low + 1]) : 0;
    moves_high = high_left && (!low_left || of_high <= of_low);
    return moves_high ? of_high : of_low;
  };
  NarrowestZone zone;
  while (high > 0 || low + 1 < lower.size()) {
    bool moves_high = false;
    zone.slope = next_slope(moves_high);
    const Corner opposite = moves_high ? lower[low] : upper[high];
    const Corner left = moves_high ? upper[high - 1] : lower[low];
    const Corner right = moves_high ? upper[high] : lower[low + 1];
    if (moves_high) {
      --high;
    } else {
      ++low;
    }
    const double derivative = lower[low].position - upper[high].position;
    if (derivative < 0) continue;
    zone.edge_length = right.position - left.position;
    zone.share = std::clamp((opposite.position - left.position) / zone.edge_length, 0.0, 1.0);
    if (derivative == 0 && (high > 0 || low + 1 < lower.size())) {
      const double last = next_slope(moves_high);
      zone.slope_range = last - zone.slope;
      zone.slope = std::clamp(0.0, zone.slope, last);
    }
    break;
  }
  return zone;
}

}  // namespace

Straightness straightness(std::span<const double> positions, std::span<const double> deviations,
                          ReferenceLine reference, double reading_uncertainty) {
  assert(positions.size() == deviations.size());
  Straightness result;
  const std::size_t n = positions.size();
  result.status = StraightnessStatus::too_few_positions;
  if (n < 3) return result;
  const double count = static_cast<double>(n);
  StraightLine& line = result.line;
  for (std::size_t i = 0; i < n; ++i) {
    line.origin += positions[i] / count;
    line.offset += deviations[i] / count;
  }
  double spread = 0, product = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = positions[i] - line.origin;
    spread += x * x;
    product += x * (deviations[i] - line.offset);
  }
  std::vector<double>& rest = result.deviations;
  rest.resize(n);
  result.positions.assign(positions.begin(), positions.end());
  if (spread > 0) line.slope = product / spread;
  double squares = 0;
  for (std::size_t i = 0; i < n; ++i) {
    rest[i] = deviations[i] - line.at(positions[i]);
    squares += rest[i] * rest[i];
  }
  // Hulls of what the least-squares line leaves: the digits go where they are needed, and slope 0 is that line.
  const std::vector<Station> stations = stations_of(positions, rest);
  if (stations.size() < 3) {
    result = {};
    result.status = StraightnessStatus::too_few_positions;
    return result;
  }
  result.status = StraightnessStatus::done;
  result.scatter = std::sqrt(squares / (count - 2));
  const double slope_reading = std::max(reading_uncertainty, result.scatter);

  NarrowestZone zone;
  if (reference == ReferenceLine::minimum_zone) {
    zone = narrowest_zone(stations);
    line.slope += zone.slope;
    for (std::size_t i = 0; i < n; ++i) rest[i] -= zone.slope * (positions[i] - line.origin);
  }
  const auto [smallest, largest] = std::minmax_element(rest.begin(), rest.end());
  result.smallest_at = static_cast<std::size_t>(smallest - rest.begin());
  result.largest_at = static_cast<std::size_t>(largest - rest.begin());
  if (reference == ReferenceLine::minimum_zone) {
    const double middle = (*smallest + *largest) / 2;
    line.offset += middle;
    for (double& value : rest) value -= middle;
    result.value_uncertainty =
        reading_uncertainty * std::sqrt(1 + zone.share * zone.share + (1 - zone.share) * (1 - zone.share));
    result.slope_uncertainty =
        std::hypot(slope_reading * std::sqrt(2.0) / zone.edge_length, zone.slope_range / std::sqrt(12.0));
  } else {
    // value = sum of w_i y_i with w = e_largest - e_smallest - (x_largest - x_smallest) (x_i - mean) / spread.
    const double run = positions[result.largest_at] - positions[result.smallest_at];
    const double variance = std::max(0.0, 2 - run * run / spread);
    result.value_uncertainty = reading_uncertainty * std::sqrt(variance);
    result.slope_uncertainty = slope_reading / std::sqrt(spread);
  }
  result.largest = rest[result.largest_at];
  result.smallest = rest[result.smallest_at];
  result.value = result.largest - result.smallest;
  return result;
}

}  // namespace abbe
