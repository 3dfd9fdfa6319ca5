#pragma once

// Internal to formats: coordinates with a fixed number of decimals, many millions of them.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "abbe/formats/text/decimal_text.h"

namespace abbe {

inline constexpr std::size_t kLongestFixedText = 40;
inline constexpr int kMostDecimals = 12;

/// Writes the value rounded to so many decimals (half away from zero), at most kLongestFixedText - 1 characters.
///
/// @param value     magnitude at most 1e12
/// @param decimals  0 to kMostDecimals
/// @returns the place behind the last digit
inline char* write_fixed(double value, int decimals, char* at) {
  const double scaled = std::abs(value) * kExactPowersOfTen[static_cast<std::size_t>(decimals)];
  // Beyond 2^53 the product has no digits left below one.
  if (!(scaled < 9007199254740992.0)) {
    return fmt::format_to_n(at, kLongestFixedText - 1, "{:.{}f}", value, decimals).out;
  }
  auto number = static_cast<std::uint64_t>(std::llround(scaled));
  if (value < 0 && number != 0) *at++ = '-';
  std::array<char, 24> digits;  // NOLINT(cppcoreguidelines-pro-type-member-init): written before they are read
  std::size_t first = digits.size();
  int written = 0;
  do {
    if (written == decimals && decimals > 0) digits[--first] = '.';
    digits[--first] = static_cast<char>('0' + number % 10);
    number /= 10;
    ++written;
  } while (number != 0 || written <= decimals);
  while (first < digits.size()) *at++ = digits[first++];
  return at;
}

}  // namespace abbe
