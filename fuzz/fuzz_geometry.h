#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstdlib>

/// Coordinates are finite and indices in range.
inline void require_sound(const Eigen::Matrix3Xd& points,
                          const Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic>& triangles) {
  if (!points.allFinite()) std::abort();
  if (triangles.cols() > 0 && triangles.maxCoeff() >= points.cols()) std::abort();
}
