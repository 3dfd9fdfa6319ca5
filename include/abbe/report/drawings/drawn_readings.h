#pragma once

// Which readings of a long scan a page draws.
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "abbe/verify/parts/surface_average.h"

namespace abbe {

/// What a page draws at most, so that it stays below its size with a scan of a million points.
inline constexpr std::size_t kPointsDrawn = 40000;

/// As it is sent: without gaps between its members.
struct DrawnReading {
  std::uint64_t number = 0;                ///< its place among the readings
  std::uint64_t is_of_group = 0;           ///< 1: chosen of its group; 0: for its amount alone
  std::array<double, 3> foot{}, normal{};  ///< mm, closest point of the part; unit, of the part there
  double deviation_mm = 0;
};

/// One of each few consecutive readings (chosen_of_group()), and those with the largest amounts; all if they are few
/// enough. Chosen while readings come, also in pieces, each of which begins with a group.
class DrawnReadings {
 public:
  /// @param measured  points of the scan, about
  explicit DrawnReadings(std::size_t measured);

  /// The next reading of this piece.
  void add(const Eigen::Vector3d& foot, const Eigen::Vector3d& normal, double deviation_mm);
  /// Readings of the next piece. @param before  number of all readings in front of it
  void append(std::span<const DrawnReading> piece, std::uint64_t before);
  /// Those that were chosen so far, in their order.
  std::vector<DrawnReading> chosen() const;
  SurfaceReadings readings() const;  ///< of chosen()

 private:
  void keep_if_large(const DrawnReading& reading);

  std::uint64_t every_, next_ = 0;
  std::vector<DrawnReading> of_groups_;
  std::vector<DrawnReading> largest_;  // a heap, whose first one is the least
};

}  // namespace abbe
