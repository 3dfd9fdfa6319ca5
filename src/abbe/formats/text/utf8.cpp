#include "abbe/formats/text/utf8.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace abbe {

std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const auto follows = [&](std::size_t i) { return (byte(i) & 0xC0U) == 0x80U; };
  const unsigned lead = byte(at), second = byte(at + 1);
  if (lead < 0x80U) return 1;
  if (lead >= 0xC2U && lead <= 0xDFU) return follows(at + 1) ? 2 : 0;
  if (lead >= 0xE0U && lead <= 0xEFU) {
    const bool overlong = lead == 0xE0U && second < 0xA0U, surrogate = lead == 0xEDU && second > 0x9FU;
    return follows(at + 1) && follows(at + 2) && !overlong && !surrogate ? 3 : 0;
  }
  if (lead >= 0xF0U && lead <= 0xF4U) {
    const bool outside = (lead == 0xF0U && second < 0x90U) || (lead == 0xF4U && second > 0x8FU);
    return follows(at + 1) && follows(at + 2) && follows(at + 3) && !outside ? 4 : 0;
  }
  return 0;
}

std::size_t characters_in(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

bool is_obeyed(std::string_view text, std::size_t at) {
  const std::size_t length = utf8_length(text, at);
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[at + i]); };
  if (length == 1) return byte(0) < 0x20U || byte(0) == 0x7FU;
  if (length == 2) return (byte(0) == 0xC2U && byte(1) < 0xA0U) || (byte(0) == 0xD8U && byte(1) == 0x9CU);
  if (length != 3 || byte(0) != 0xE2U) return false;
  // U+200E and U+200F, U+2028 to U+202E, U+2066 to U+2069; U+061C is above.
  if (byte(1) == 0x80U) return byte(2) == 0x8EU || byte(2) == 0x8FU || (byte(2) >= 0xA8U && byte(2) <= 0xAEU);
  return byte(1) == 0x81U && byte(2) >= 0xA6U && byte(2) <= 0xA9U;
}

bool has_control_character(std::string_view text) {
  for (std::size_t at = 0; at < text.size(); at += std::max<std::size_t>(utf8_length(text, at), 1)) {
    if (text[at] != '\t' && utf8_length(text, at) <= 2 && is_obeyed(text, at)) return true;
  }
  return false;
}

std::string printable(std::string_view text, std::size_t most, LineFeeds line_feeds) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    if (at >= most) return out + "...";
    const std::size_t length = utf8_length(text, at), bytes = std::max<std::size_t>(length, 1);
    const bool kept = text[at] == '\t' || (text[at] == '\n' && line_feeds == LineFeeds::kept);
    if (kept || (length > 0 && !is_obeyed(text, at))) {
      out += text.substr(at, bytes);
    } else {
      for (std::size_t i = at; i < at + bytes; ++i) {
        out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[i]));
      }
    }
    at += bytes;
  }
  return out;
}

std::string PrintableText::next(std::string_view piece) {
  std::string text = std::exchange(begun_, std::string());
  text += piece;
  // A character of up to four bytes may go on in the next piece.
  for (std::size_t at = text.size() - std::min<std::size_t>(text.size(), 3); at < text.size(); ++at) {
    const auto lead = static_cast<unsigned char>(text[at]);
    const std::size_t whole = lead >= 0xF0U ? 4 : lead >= 0xE0U ? 3 : lead >= 0xC2U ? 2 : 1;
    if (text.size() - at >= whole) continue;
    begun_ = text.substr(at);
    text.resize(at);
  }
  return printable(text, text.size());
}

std::string PrintableText::rest() {
  const std::string text = std::exchange(begun_, std::string());
  return printable(text, text.size());
}

}  // namespace abbe
