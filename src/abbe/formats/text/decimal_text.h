#pragma once

// Internal to formats: the short way of reading the decimals that files are full of.
#include <array>
#include <cstddef>
#include <cstdint>

namespace abbe {

inline constexpr std::array<double, 23> kExactPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                             1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                             1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// Reads decimals of at most 19 digits, with or without an exponent, not with a plus: one exact operation, see
/// number_text.cpp.
/// @returns the place behind the last digit, which the caller has to look at, or null if the number has to be read the
///          long way, by parse_number()
///
/// Inlined in every reader: where several readers share a unit, GCC 12 calls it otherwise, and text files take a tenth
/// longer to read.
[[gnu::always_inline]] inline const char* read_short_decimal(const char* at, const char* end, int decimal_shift,
                                                             double& value) {
  bool negative = false;
  if (at != end && *at == '-') {
    negative = true;
    ++at;
  }
  const char* const start = at;
  std::uint64_t digits = 0;
  for (; at != end && static_cast<unsigned char>(*at - '0') < 10; ++at) {
    digits = digits * 10 + static_cast<std::uint64_t>(*at - '0');
  }
  std::ptrdiff_t count = at - start;
  int exponent = decimal_shift;
  if (at != end && *at == '.') {
    const char* const fraction = ++at;
    for (; at != end && static_cast<unsigned char>(*at - '0') < 10; ++at) {
      digits = digits * 10 + static_cast<std::uint64_t>(*at - '0');
    }
    count += at - fraction;
    if (count > 19) return nullptr;
    exponent -= static_cast<int>(at - fraction);
  }
  if (at != end && (*at == 'e' || *at == 'E')) {
    ++at;
    const bool below_one = at != end && *at == '-';
    if (at != end && (*at == '-' || *at == '+')) ++at;
    const char* const first = at;
    int written = 0;
    for (; at != end && at - first < 4 && static_cast<unsigned char>(*at - '0') < 10; ++at) {
      written = written * 10 + (*at - '0');
    }
    if (at == first || at - first == 4) return nullptr;
    exponent += below_one ? -written : written;
  }
  if (count == 0 || count > 19 || digits > (std::uint64_t{1} << 53) || exponent < -22 || exponent > 22) return nullptr;
  const double exact = static_cast<double>(digits);
  const double result = exponent < 0 ? exact / kExactPowersOfTen[static_cast<std::size_t>(-exponent)]
                                     : exact * kExactPowersOfTen[static_cast<std::size_t>(exponent)];
  value = negative ? -result : result;
  return at;
}

}  // namespace abbe
