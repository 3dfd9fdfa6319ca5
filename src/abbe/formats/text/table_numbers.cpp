#include "abbe/formats/text/table_numbers.h"

#include <fmt/format.h>

#include <cmath>

#include "abbe/formats/nc/program_text.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/text_cursor.h"
#include "abbe/geometry/angle_units.h"

namespace abbe {

std::string trimmed_decimals(double value, int decimals) {
  std::string text = fixed_number(value, decimals);
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

double shown_position(double value, bool rotary) { return rotary ? value * (1 / kDegree) : value; }
double inside_position(double value, bool rotary) { return rotary ? value * kDegree : value; }

std::string shown_position_text(double value, bool rotary) {
  return trimmed_decimals(shown_position(value, rotary), 9);
}

bool TableLines::next() {
  if (at_ >= text_.size()) return false;
  const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
  line_ = text_.substr(at_, end - at_);
  at_ = end;
  if (at_ < text_.size()) at_ += text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n' ? 2 : 1;
  ++number_;
  return true;
}

void TableLines::fail(const std::string& field, const std::string& problem, const std::string& expected) const {
  throw InputError({.file = file_, .line = number_, .field = field}, problem, expected);
}

double TableLines::value(std::string_view word, const std::string& field, const std::string& expected) const {
  double number = 0;
  switch (parse_number(word, 0, number)) {
    case NumberProblem::none:
      if (std::abs(number) <= kLargestInput) return number;
      [[fallthrough]];
    case NumberProblem::too_large:
      fail(field, fmt::format("'{}' is too large", shown_word(word)), expected);
    case NumberProblem::not_finite:
      fail(field, fmt::format("'{}' is not a finite number", shown_word(word)), expected);
    case NumberProblem::not_a_number:
      break;
  }
  if (word.empty()) fail(field, "is missing", expected);
  fail(field, fmt::format("'{}' is not a number", shown_word(word)), expected);
}

std::size_t TableLines::whole(std::string_view word, const std::string& field, std::size_t least,
                              std::size_t most) const {
  const std::string expected = fmt::format("a whole number from {} to {}", least, most);
  const double number = value(word, field, expected);
  if (!(number >= static_cast<double>(least) && number <= static_cast<double>(most)) || number != std::floor(number)) {
    fail(field, fmt::format("'{}' is out of range", shown_word(word)), expected);
  }
  return static_cast<std::size_t>(number);
}

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  std::size_t at = 0;
  while (at < line.size()) {
    if (is_blank(line[at])) {
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < line.size() && !is_blank(line[end])) ++end;
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

}  // namespace abbe
