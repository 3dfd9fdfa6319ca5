#include "abbe/formats/shapes/lzf.h"

#include <cstddef>
#include <cstring>

namespace abbe {

bool lzf_decompress(std::string_view compressed, std::span<char> out) {
  const auto byte = [&](std::size_t i) -> std::size_t { return static_cast<unsigned char>(compressed[i]); };
  std::size_t at = 0, to = 0;
  while (at < compressed.size()) {
    const std::size_t control = byte(at++);
    if (control < 32) {
      const std::size_t length = control + 1;
      if (compressed.size() - at < length || out.size() - to < length) return false;
      std::memcpy(out.data() + to, compressed.data() + at, length);
      at += length;
      to += length;
      continue;
    }
    std::size_t length = control >> 5U;
    if (length == 7) {
      if (at == compressed.size()) return false;
      length += byte(at++);
    }
    length += 2;
    if (at == compressed.size()) return false;
    const std::size_t back = ((control & 31U) << 8U) + byte(at++) + 1;
    if (back > to || out.size() - to < length) return false;
    const char* const from = out.data() + to - back;
    if (back >= length) {
      std::memcpy(out.data() + to, from, length);
    } else {
      // What is copied goes on while it is written: a run of repeated bytes.
      for (std::size_t i = 0; i < length; ++i) out[to + i] = from[i];
    }
    to += length;
  }
  return to == out.size();
}

}  // namespace abbe
