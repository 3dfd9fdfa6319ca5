#pragma once

// Internal to geometry: one pass over all points of a registration, which several processes can share.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "abbe/geometry/numbered_work.h"
#include "abbe/geometry/registration/fine_registration.h"

namespace abbe {

/// Sums over some points; rotations are scaled by the extent, so that all six parameters are lengths.
struct WeightedSums {
  Matrix6d hessian = Matrix6d::Zero(), slope = Matrix6d::Zero(), square = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double weighted_square = 0, weight = 0;
  Eigen::Index used = 0, beyond_border = 0;

  void operator+=(const WeightedSums& other);
};

/// Distances of the points of a block: those within a window, and how many there are.
struct BlockDistances {
  std::vector<double> within;
  std::size_t below = 0, all = 0;
};

/// Between which distances the median is looked for; both ends included.
struct DistanceWindow {
  double low = 0, high = std::numeric_limits<double>::infinity();
};

/// Distance of which half of all are smaller. @returns nothing if it is not within the window; 0 without distances
std::optional<double> median_distance(std::span<const BlockDistances> blocks);

/// Blocks of points, each of which leaves its sums and distances.
struct RegistrationPass {
  std::size_t points = 0;
  std::span<WeightedSums> sums;         ///< [blocks]
  std::span<BlockDistances> distances;  ///< [blocks]
  std::function<void(std::size_t block)> compute{};
  std::function<std::uint64_t()> fingerprint{};  ///< of everything that they depend on
};

/// Fewer points are not shared: sending would take longer than computing.
inline constexpr std::size_t kLeastSharedPoints = 16384;

/// Every process has all sums and distances afterwards, in their places. Few points are not shared.
void do_pass(const RegistrationPass& pass, const WorkDriver& driver, int threads);

}  // namespace abbe
