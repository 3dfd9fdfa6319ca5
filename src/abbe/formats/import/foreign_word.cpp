#include "abbe/formats/import/foreign_word.h"

#include "abbe/formats/text/ascii_letters.h"

namespace abbe {

std::string small_letters(std::string_view text) {
  std::string small;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool umlaut = i > 0 && static_cast<unsigned char>(text[i - 1]) == 0xC3U && byte >= 0x80U && byte <= 0x9EU;
    small += umlaut ? static_cast<char>(byte + 0x20U) : lower_case(text[i]);
  }
  return small;
}

std::string comparable_word(std::string_view text, bool keep_case) {
  const std::string letters = keep_case ? std::string(text) : small_letters(text);
  std::string word;
  bool gap = false;
  for (const char c : letters) {
    // Bytes of UTF-8 beyond ASCII are letters here.
    const bool kept = is_letter(c) || is_digit(c) || static_cast<unsigned char>(c) >= 0x80U || c == '+' || c == '\'';
    if (kept) {
      if (gap && !word.empty()) word += ' ';
      word += c;
    }
    gap = !kept;
  }
  return word;
}

}  // namespace abbe
