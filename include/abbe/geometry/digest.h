#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string_view>

namespace abbe {

/// Fingerprint of a sequence of numbers: tells data apart that differ by mistake, not on purpose.
class Digest {
 public:
  void add(std::uint64_t value) {
    state_ = std::rotl(state_ ^ value, 23) * 0x9fb21c651e98df25U;
    state_ ^= state_ >> 29;
  }
  void add_number(double value) {
    // What is no number has many patterns of bits, which say nothing.
    add(std::bit_cast<std::uint64_t>(std::isnan(value) ? std::numeric_limits<double>::quiet_NaN() : value));
  }
  /// In words of 8 bytes, as the processor reads them.
  void add_bytes(std::span<const std::byte> bytes) {
    for (std::size_t k = 0; k < bytes.size(); k += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes.data() + k, std::min<std::size_t>(8, bytes.size() - k));
      add(word);
    }
    add(bytes.size());
  }
  void add_numbers(std::span<const double> values) {
    for (const double value : values) add_number(value);
    add(values.size());
  }
  void add_text(std::string_view text) { add_bytes(std::as_bytes(std::span(text.data(), text.size()))); }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0x243f6a8885a308d3U;
};

}  // namespace abbe
