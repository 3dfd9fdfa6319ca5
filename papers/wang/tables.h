#pragma once

#include <cstddef>

namespace abbe {

/// One column i of one of Wang's Tables A1 to A6.
struct WangRow {
  double position;    ///< mm or deg
  double dx, dy, dz;  ///< um
  double ex, ey, ez;  ///< as printed, "degrees"
};

/// Axes in the order of the tables.
inline constexpr const char* kWangAxisNames[6] = {"X", "Y", "Z", "A", "B", "C"};

/// @param axis  0 to 5: X Y Z A B C
/// @param i     0 to 11; 11 is the mean of the others, not a measurement
const WangRow& wang_row(std::size_t axis, std::size_t i);

}  // namespace abbe
