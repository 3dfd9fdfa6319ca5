#pragma once

// Internal to formats: units of NC programs.
#include <cstddef>

namespace abbe {

inline constexpr double kInch = 25.4;  ///< mm

/// Whether an axis word (see nc_axis()) is of a rotary axis: A, B or C, in degrees in a program.
inline bool is_rotary_word(std::size_t axis) { return axis >= 3 && axis <= 5; }

}  // namespace abbe
