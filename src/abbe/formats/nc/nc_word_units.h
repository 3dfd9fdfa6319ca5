#pragma once

// Internal to formats: words of corrected programs in units of their last decimal.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>

namespace abbe {

inline constexpr double kLargestUnits = 9e15;

/// Half away from zero; a number that no word has if it is too large.
inline std::int64_t rounded_units(double units) {
  if (!(std::abs(units) < kLargestUnits)) return std::numeric_limits<std::int64_t>::min();
  return static_cast<std::int64_t>(units + (units < 0 ? -0.5 : 0.5));
}

/// @returns behind what was written
inline char* write_text(std::string_view text, char* at) {
  std::memcpy(at, text.data(), text.size());
  return at + text.size();
}

}  // namespace abbe
