#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace abbe {

/// Numbers as text for a page: their bytes, the lowest first, in base64 (RFC 4648, 4). A tenth to a third of what
/// decimal text takes.
std::string packed(std::span<const std::uint8_t> numbers);
std::string packed(std::span<const std::int8_t> numbers);
std::string packed(std::span<const std::int16_t> numbers);
std::string packed(std::span<const std::uint16_t> numbers);
std::string packed(std::span<const std::uint32_t> numbers);

}  // namespace abbe
