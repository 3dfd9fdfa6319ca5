#pragma once

// Internal to formats: normals as files have them.
#include <Eigen/Core>
#include <cmath>

namespace abbe {

/// Makes a vector one long; leaves it alone if it is, so that what was written reads back to the same bits.
/// @returns false if it has no direction
template <typename Column>
bool make_unit(Column&& normal) {
  const double length = normal.stableNorm();
  if (!(length > 1e-12) || !std::isfinite(length)) return false;
  if (std::abs(length - 1) > 1e-14) normal /= length;
  return true;
}

}  // namespace abbe
