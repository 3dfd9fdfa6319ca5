#pragma once

// Internal to formats: units of NC programs, and values of axis words in them.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "abbe/compensate/program/program_move.h"

namespace abbe {

inline constexpr double kInch = 25.4;  ///< mm

/// Letters of the axis words in the order of AxisWord, as blocks have them and as messages and programs say them.
inline constexpr std::string_view kAxisLetters = "xyzabcuvw", kWrittenAxisLetters = "XYZABCUVW";

/// One value per axis word as the control has it: mm, degrees.
using NcAxisValues = std::array<double, kAxisWords>;

/// Axis words as bits, X the lowest.
inline constexpr std::uint32_t kXyzWords = 0b111, kRotaryWords = 0b111000;
inline constexpr std::uint32_t axis_bit(std::size_t axis) { return std::uint32_t{1} << axis; }

/// Calls `take` with the index of each axis word of `words`, X first.
template <typename Take>
void for_axes(std::uint32_t words, Take&& take) {
  for (; words != 0; words &= words - 1) take(static_cast<std::size_t>(std::countr_zero(words)));
}

}  // namespace abbe
