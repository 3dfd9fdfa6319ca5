#include "abbe/formats/text/text_cursor.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "abbe/formats/text/decimal_text.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/text_blocks.h"

namespace abbe {

std::string shown_word(std::string_view word) {
  constexpr std::size_t kShown = 20;
  std::string text(word.substr(0, kShown));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) - 0x20U >= 0x5fU; }, '.');
  return word.size() > kShown ? text + "..." : text;
}

void TextCursor::skip_blanks() {
  while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  word_at_ = at_;
}

std::string_view TextCursor::word() {
  skip_blanks();
  while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
  return text_.substr(word_at_, at_ - word_at_);
}

bool TextCursor::take(std::string_view word) {
  std::size_t at = at_;
  while (at < text_.size() && is_blank(text_[at])) ++at;
  const std::size_t behind = at + word.size();
  if (text_.compare(at, word.size(), word) != 0 || (behind < text_.size() && !is_blank(text_[behind]))) return false;
  word_at_ = at;
  at_ = behind;
  return true;
}

double TextCursor::number(const char* field) {
  skip_blanks();
  double value = 0;
  const char* const end = text_.data() + text_.size();
  const char* const behind = read_short_decimal(text_.data() + at_, end, 0, value);
  if (behind != nullptr && (behind == end || is_blank(*behind)) && std::abs(value) <= kLargestInput) {
    at_ = static_cast<std::size_t>(behind - text_.data());
    return value;
  }
  const std::string_view text = word();
  if (text.empty()) fail(field, "the file ends", "a number");
  const NumberProblem problem = parse_number(text, 0, value);
  if (problem == NumberProblem::not_a_number) fail(field, fmt::format("'{}' is not a number", shown_word(text)), "");
  if (problem == NumberProblem::not_finite) {
    fail(field, fmt::format("'{}' is not a finite number", shown_word(text)), "");
  }
  if (problem == NumberProblem::too_large || std::abs(value) > kLargestInput) {
    fail(field, fmt::format("'{}' is too large", shown_word(text)), "at most 1e9");
  }
  return value;
}

long long TextCursor::integer(const char* field) {
  const std::string_view text = word();
  long long value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || result.ec != std::errc() || result.ptr != text.data() + text.size()) {
    fail(field, text.empty() ? "the file ends" : fmt::format("'{}' is not a whole number", shown_word(text)),
         "a whole number");
  }
  return value;
}

std::string_view TextCursor::line() {
  word_at_ = at_;
  const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
  const std::string_view line = text_.substr(at_, end - at_);
  at_ = end;
  if (at_ < text_.size() && text_[at_] == '\r') ++at_;
  if (at_ < text_.size() && text_[at_] == '\n' && (end == at_ || text_[end] == '\r')) ++at_;
  return line;
}

void TextCursor::fail(const std::string& field, const std::string& problem, const std::string& expected) const {
  throw_refusal(text_, file_, {word_at_, field, problem, expected});
}

}  // namespace abbe
