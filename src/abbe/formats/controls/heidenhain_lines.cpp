#include "abbe/formats/controls/heidenhain_lines.h"

#include "abbe/formats/nc/program_text.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {

std::string heidenhain_number(double value, bool rotary) {
  return fixed_number(shown_position(value, rotary), rotary ? 7 : 6);
}

HeidenhainLines::HeidenhainLines(std::string_view text, const std::string& file, const char* begin, const char* columns)
    : file_(file), lines_(text, file) {
  if (!lines_.next() || !line().starts_with("BEGIN ") || words_of(line()).back() != "MM") {
    throw InputError({.file = file_, .line = 1}, "no table of a control", begin);
  }
  if (!lines_.next()) throw InputError({.file = file_}, "no columns", columns);
}

bool HeidenhainLines::next() {
  while (lines_.next()) {
    const std::vector<std::string_view> words = words_of(line());
    if (words.empty()) continue;
    if (ended_) lines_.fail("", "text behind [END]", "the end of the file");
    if (words.front() != "[END]") return true;
    ended_ = true;
  }
  return false;
}

void HeidenhainLines::check_number(std::string_view word, std::size_t row, std::size_t rows_at_most) const {
  if (lines_.whole(word, "NR", 0, rows_at_most - 1) != row) lines_.fail("NR", "is not the next number", "0, 1, 2 ...");
}

void HeidenhainLines::check_end(std::size_t rows) const {
  if (!ended_ || rows == 0) throw InputError({.file = file_}, ended_ ? "no rows" : "no [END]", "rows, and [END]");
}

}  // namespace abbe
