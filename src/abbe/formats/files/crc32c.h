#pragma once

#include <cstdint>
#include <string_view>

namespace abbe {

/// CRC-32C (Castagnoli's polynomial 0x1EDC6F41, reflected, all bits set at the start and inverted at the end).
std::uint32_t crc32c(std::string_view bytes);

}  // namespace abbe
