#pragma once

// For tests: gzip files (RFC 1952) made without zlib, of stored blocks (RFC 1951, 3.2.4).
#include <cstdint>
#include <string>
#include <string_view>

namespace abbe::test {

/// @param text  of at most 65535 bytes
inline std::string gzip_of(std::string_view text) {
  std::uint32_t sum = 0xFFFFFFFFU;  // CRC-32, bit by bit
  for (const char c : text) {
    sum ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1U) ^ ((sum & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  sum = ~sum;
  std::string bytes("\x1f\x8b\x08\0\0\0\0\0\0\xff\x01", 11);
  const auto put = [&](std::uint32_t value, int count) {
    for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFFU);
  };
  const auto length = static_cast<std::uint32_t>(text.size());
  put(length, 2);
  put(~length, 2);
  bytes += text;
  put(sum, 4);
  put(length, 4);
  return bytes;
}

/// Text of ASCII as UTF-16 without a byte order mark.
inline std::string utf16_of(std::string_view ascii, bool big_end_first) {
  std::string bytes;
  for (const char c : ascii) {
    if (big_end_first) bytes += '\0';
    bytes += c;
    if (!big_end_first) bytes += '\0';
  }
  return bytes;
}

}  // namespace abbe::test
