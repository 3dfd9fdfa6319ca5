#pragma once

// Internal to geometry: which small motions of a scan its points see, which several processes can find out together.
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "abbe/geometry/numbered_work.h"
#include "abbe/geometry/registration/fine_registration.h"

namespace abbe {

/// How the distance of a point from the part changes with a small motion in the frame of the part.
struct MotionRow {
  double weight = 0;  ///< of the point, 0 to 1
  Vector6d gradient;  ///< by the rotation vector times the extent of the points and by the shift, both in mm
};

/// Blocks of points, each of which leaves its rows.
struct MotionPass {
  std::size_t points = 0;                  ///< of the scan
  std::span<std::vector<MotionRow>> rows;  ///< [blocks], empty
  std::function<void(std::size_t block)> compute{};
  std::function<std::uint64_t()> fingerprint{};  ///< of everything that they depend on
};

/// Every process has all rows afterwards, in their places. Those of few points are not shared.
void do_motion_pass(const MotionPass& pass, const WorkDriver& driver, int threads);

/// Motions that move the points across the surface, as columns; the others move them along it.
struct SeenMotions {
  Eigen::MatrixXd seen, unseen;  ///< [6, k], orthonormal in the scaled parameters
};

/// @param rows  of all blocks, in their order
SeenMotions seen_motions_of(std::span<const std::vector<MotionRow>> rows);

}  // namespace abbe
