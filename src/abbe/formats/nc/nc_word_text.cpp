#include "abbe/formats/nc/nc_word_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/formats/text/ascii_letters.h"

namespace abbe {
namespace {

bool is_plain(const NcWord& word) {
  return std::none_of(word.begin + 1, word.end, [](char c) { return c == '[' || c == '#' || is_letter(c); });
}

}  // namespace

std::string plain_nc_number(double value) {
  std::string text = fmt::format("{:.10f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

void append_nc_word(std::string& text, const NcBlock& block, const NcWord& word) {
  if (!text.empty()) text += ' ';
  if (!block.is_computed || is_plain(word)) {
    text.append(word.begin, word.end);
    while (text.back() == ' ' || text.back() == '\t') text.pop_back();
    return;
  }
  text += static_cast<char>(word.letter - 'a' + 'A');
  text += plain_nc_number(word.value);
}

}  // namespace abbe
