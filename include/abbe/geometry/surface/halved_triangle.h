#pragma once

// For geometry and the program abbe-step: triangles divided where their sides were halved.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace abbe {

using TriangleCorners = std::array<std::uint32_t, 3>;

/// In the place of the middle of a side that was not halved.
constexpr std::uint32_t kNoMiddle = 0xffffffffU;

/// The same for both directions of a side.
inline std::uint64_t side_key(std::uint32_t a, std::uint32_t b) {
  return (static_cast<std::uint64_t>(std::min(a, b)) << 32U) | std::max(a, b);
}

/// Divides a triangle into two, three or four that run the same way round; neighbours that know the same middles go on
/// sharing sides. Without a middle the triangle itself comes back.
/// @param middles  of the sides from corner 0 to 1, 1 to 2, 2 to 0, or kNoMiddle
/// @param squared_distance(a, b)  of two corners or middles: of two diagonals the shorter one is taken
/// @param add(triangle)           called with each part
template <typename SquaredDistance, typename Add>
void add_halved(const TriangleCorners& corners, const std::array<std::uint32_t, 3>& middles,
                const SquaredDistance& squared_distance, const Add& add) {
  const auto count = 3 - std::count(middles.begin(), middles.end(), kNoMiddle);
  // Turned so that the first side is the halved one, or the last side the whole one.
  std::size_t first = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (count == 1 ? middles[k] != kNoMiddle : count == 2 && middles[(k + 2) % 3] == kNoMiddle) first = k;
  }
  const std::uint32_t a = corners[first], b = corners[(first + 1) % 3], c = corners[(first + 2) % 3];
  const std::uint32_t ab = middles[first], bc = middles[(first + 1) % 3], ca = middles[(first + 2) % 3];
  if (count == 0) {
    add({a, b, c});
  } else if (count == 1) {
    add({a, ab, c});
    add({ab, b, c});
  } else if (count == 2) {
    add({ab, b, bc});
    const bool from_a = squared_distance(a, bc) <= squared_distance(c, ab);
    add({a, ab, from_a ? bc : c});
    add({from_a ? a : ab, bc, c});
  } else {
    add({a, ab, ca});
    add({ab, b, bc});
    add({ca, bc, c});
    add({ab, bc, ca});
  }
}

}  // namespace abbe
