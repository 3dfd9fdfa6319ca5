#include "abbe/report/drawings/packed_numbers.h"

#include <type_traits>
#include <vector>

namespace abbe {
namespace {

std::string base64(const std::vector<std::uint8_t>& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const unsigned group = (static_cast<unsigned>(bytes[i]) << 16U) |
                           (left > 1 ? static_cast<unsigned>(bytes[i + 1]) << 8U : 0U) |
                           (left > 2 ? static_cast<unsigned>(bytes[i + 2]) : 0U);
    text += kDigits[group >> 18U & 63U];
    text += kDigits[group >> 12U & 63U];
    text += left > 1 ? kDigits[group >> 6U & 63U] : '=';
    text += left > 2 ? kDigits[group & 63U] : '=';
  }
  return text;
}

template <class Number>
std::string packed_numbers(std::span<const Number> numbers) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(numbers.size() * sizeof(Number));
  for (const Number number : numbers) {
    const auto bits = static_cast<std::make_unsigned_t<Number>>(number);
    for (std::size_t k = 0; k < sizeof(Number); ++k) {
      bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint32_t>(bits) >> (8U * k) & 0xffU));
    }
  }
  return base64(bytes);
}

}  // namespace

std::string packed(std::span<const std::uint8_t> numbers) { return packed_numbers(numbers); }
std::string packed(std::span<const std::int8_t> numbers) { return packed_numbers(numbers); }
std::string packed(std::span<const std::int16_t> numbers) { return packed_numbers(numbers); }
std::string packed(std::span<const std::uint16_t> numbers) { return packed_numbers(numbers); }
std::string packed(std::span<const std::uint32_t> numbers) { return packed_numbers(numbers); }

}  // namespace abbe
