#pragma once

// Internal to formats: numbers of NC programs from integers of their last decimal.
#include <array>
#include <cstddef>
#include <cstdint>

namespace abbe {

inline constexpr auto kDigitPairs = [] {
  std::array<char, 200> pairs{};
  for (std::size_t i = 0; i < 100; ++i) {
    pairs[2 * i] = static_cast<char>('0' + i / 10);
    pairs[2 * i + 1] = static_cast<char>('0' + i % 10);
  }
  return pairs;
}();

/// Writes number / 10^decimals with all decimals, or without zeros at the end; at most 22 characters.
/// @param decimals  0 to 15
inline char* write_scaled(std::int64_t number, int decimals, bool trim, char* at) {
  std::uint64_t left = static_cast<std::uint64_t>(number);
  if (number < 0) {
    *at++ = '-';
    left = 0 - left;
  }
  if (trim) {
    while (decimals > 0 && left % 10 == 0) {
      left /= 10;
      --decimals;
    }
  }
  std::array<char, 24> digits;
  digits.fill('0');
  std::size_t first = digits.size();
  while (left >= 100) {
    const std::size_t pair = static_cast<std::size_t>(left % 100) * 2;
    left /= 100;
    digits[--first] = kDigitPairs[pair + 1];
    digits[--first] = kDigitPairs[pair];
  }
  if (left >= 10) {
    digits[--first] = kDigitPairs[static_cast<std::size_t>(left) * 2 + 1];
    digits[--first] = kDigitPairs[static_cast<std::size_t>(left) * 2];
  } else {
    digits[--first] = static_cast<char>('0' + left);
  }
  const std::size_t point = digits.size() - static_cast<std::size_t>(decimals);
  if (first >= point) first = point - 1;
  while (first < point) *at++ = digits[first++];
  if (decimals > 0) {
    *at++ = '.';
    while (first < digits.size()) *at++ = digits[first++];
  }
  return at;
}

}  // namespace abbe
