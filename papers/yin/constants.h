#pragma once

#include <cstdint>

/// What the study of Yin et al. (2021) assumes beside the paper's numbers, in one place.
namespace abbe::yin {

inline constexpr std::uint64_t kSeed = 2021;

// Table 3: x, y, z in mm, alpha, beta, gamma in degrees.
inline constexpr double kTable3[] = {-73.896, 94.924, 33.385, -0.103, -0.034, -0.097};

// Standard uncertainties, mm: a target and a point of a surface to the area scanner, the height gauge under the sphere,
// the place of a section's origin across the curve.
inline constexpr double kTargetNoise = 0.010, kSurfaceNoise = 0.020, kHeightNoise = 0.005, kSectionPlace = 0.002;

// mm, as in the reference (golden/yin): from the exit of the beam to the axis, thickness of the board, the sphere and
// the height of its centre above the table.
inline constexpr double kExitToAxis = 120, kBoard = 4, kSphereRadius = 12.7, kSphereHeight = 95;

// The beam: waist in mm, tangent of its divergence.
inline constexpr double kWaist = 0.03, kDivergence = 0.05;

// mm; the paper states neither: rounding and depth of the engraved edges.
inline constexpr double kEdgeRadius = 0.015, kEdgeDepth = 0.1;

}  // namespace abbe::yin
