#include "abbe/formats/files/crc32c.h"

#include <array>
#include <cstddef>
#include <cstring>

namespace abbe {
namespace {

/// Table k is the remainder of a byte with k zero bytes after it: eight bytes at a time (M. Kounavis, F. Berry,
/// "A systematic approach to building high performance software-based CRC generators", ISCC 2005).
constexpr std::array<std::array<std::uint32_t, 256>, 8> crc32c_tables() {
  std::array<std::array<std::uint32_t, 256>, 8> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) remainder = (remainder >> 1U) ^ ((remainder & 1U) * 0x82F63B78U);
    tables[0][byte] = remainder;
  }
  for (std::size_t k = 1; k < 8; ++k) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[k - 1][byte];
      tables[k][byte] = (before >> 8U) ^ tables[0][before & 0xffU];
    }
  }
  return tables;
}

constexpr std::array<std::array<std::uint32_t, 256>, 8> kCrc32cTables = crc32c_tables();

}  // namespace

std::uint32_t crc32c(std::string_view bytes) {
  std::uint32_t remainder = 0xffffffffU;
  const char* at = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= 8; left -= 8, at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, at, 8);
    word ^= remainder;
    remainder = 0;
    for (std::size_t k = 0; k < 8; ++k) remainder ^= kCrc32cTables[7 - k][word >> (8 * k) & 0xffU];
  }
  for (; left > 0; --left, ++at) {
    remainder = (remainder >> 8U) ^ kCrc32cTables[0][(remainder ^ static_cast<unsigned char>(*at)) & 0xffU];
  }
  return ~remainder;
}

}  // namespace abbe
