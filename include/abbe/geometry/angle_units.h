#pragma once

#include <numbers>

namespace abbe {

/// Units of angles, in rad.
inline constexpr double kDegree = std::numbers::pi / 180;
inline constexpr double kArcsec = std::numbers::pi / (180 * 3600);
inline constexpr double kTurn = 2 * std::numbers::pi;

}  // namespace abbe
