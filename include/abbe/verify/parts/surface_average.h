#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace abbe {

/// Points of a scan as seen from the surface.
struct SurfaceReadings {
  Eigen::Matrix3Xd foot;             ///< [3, n] mm, closest points on the surface
  Eigen::Matrix3Xd normal;           ///< [3, n] unit, of the surface there
  std::vector<double> deviation_mm;  ///< [n]
};

/// Mean deviations about places of a surface, as a map of colours shows them.
struct SurfaceAverage {
  std::vector<double> mean_mm;       ///< [places] 0 where there is no reading
  std::vector<std::uint32_t> count;  ///< [places] readings in the mean
};

/// Of more readings than that, about so many tell how dense they are.
inline constexpr std::size_t kRadiusReadings = 65536;

/// Radius in which there are some readings about most places: half of the occupied cubes of a grid of that edge have
/// at least `wanted` of them; at most a tenth of the extent.
/// @return mm; 0 if there are no readings
double radius_of_readings(const SurfaceReadings& readings, std::size_t wanted = 4);

/// Mean of the readings whose feet lie within the radius and on the same side of the part (normals within 60 degrees).
///
/// A mean over a radius hides what is smaller: it is for pictures, figures come from the readings themselves.
/// @param places   [3, m] mm, on the surface
/// @param normals  [3, m] unit, or zero: either side counts
/// @param threads  0: all; the result does not depend on it
SurfaceAverage surface_average(const SurfaceReadings& readings, const Eigen::Matrix3Xd& places,
                               const Eigen::Matrix3Xd& normals, double radius_mm, int threads = 0);

}  // namespace abbe
