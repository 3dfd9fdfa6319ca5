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
  std::array<char, 24> digits;  // NOLINT(cppcoreguidelines-pro-type-member-init): written before they are read
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
  while (first >= point) digits[--first] = '0';
  while (first < point) *at++ = digits[first++];
  if (decimals > 0) {
    *at++ = '.';
    while (first < digits.size()) *at++ = digits[first++];
  }
  return at;
}

}  // namespace abbe
