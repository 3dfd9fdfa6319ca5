#pragma once

// Internal to geometry: one pass over all points of a registration, which several processes can share.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

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

/// Blocks of points, each of which leaves its sums and the distances of its points.
struct RegistrationPass {
  std::size_t block_points = 0;
  std::span<WeightedSums> sums;  ///< [blocks]
  std::span<double> distances;   ///< [points]
  std::function<void(std::size_t block)> compute;
  std::function<std::uint64_t()> fingerprint;  ///< of everything that they depend on
};

/// Every process has all sums and distances afterwards, in their places. Few points are not shared: sending would take
/// longer than computing.
void do_pass(const RegistrationPass& pass, const WorkDriver& driver, int threads);

}  // namespace abbe
