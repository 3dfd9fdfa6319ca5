#include "abbe/formats/robot/robot_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/line_numbers.h"
#include "abbe/formats/text/text_cursor.h"

namespace abbe {
namespace {

bool is_robot_word(char c) { return is_letter(c) || is_digit(c) || c == '_' || c == '$'; }

}  // namespace

bool same_robot_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char left, char right) { return upper_case(left) == upper_case(right); });
}

RobotScan::RobotScan(std::string_view text, const std::string& file, char comment) : code_(text), file_(file) {
  bool in_text = false, in_comment = false;
  for (char& c : code_) {
    if (c == '\n') {
      in_text = in_comment = false;
    } else if (in_comment) {
      c = ' ';
    } else if (c == '"') {
      in_text = !in_text;
      c = ' ';
    } else if (in_text) {
      c = ' ';
    } else if (comment != 0 && c == comment) {
      in_comment = true;
      c = ' ';
    }
  }
}

char RobotScan::peek() {
  while (at < code_.size() && is_blank(code_[at])) ++at;
  return at < code_.size() ? code_[at] : '\0';
}

bool RobotScan::take(char c) {
  if (peek() != c || at_end()) return false;
  ++at;
  return true;
}

void RobotScan::expect(char c, const std::string& field, const std::string& expected) {
  if (take(c)) return;
  fail(at, field, at_end() ? "the file ends here" : fmt::format("found '{}'", shown_word({&code_[at], 1})),
       fmt::format("'{}': {}", c, expected));
}

std::string_view RobotScan::word() {
  peek();
  const std::size_t begin = at;
  while (at < code_.size() && is_robot_word(code_[at])) ++at;
  return std::string_view(code_).substr(begin, at - begin);
}

std::string_view RobotScan::next_word() {
  while (at < code_.size() && !is_robot_word(code_[at])) ++at;
  return word();
}

std::size_t RobotScan::number_end(std::size_t begin) const {
  std::size_t end = begin;
  while (end < code_.size()) {
    const char c = code_[end];
    const bool sign = c == '+' || c == '-';
    const bool may_be_signed = end == begin || code_[end - 1] == 'e' || code_[end - 1] == 'E';
    if (!(is_digit(c) || c == '.' || ((c == 'e' || c == 'E') && end > begin) || (sign && may_be_signed))) break;
    ++end;
  }
  return end;
}

bool RobotScan::is_number() {
  peek();
  const std::size_t end = number_end(at);
  return std::any_of(code_.begin() + static_cast<std::ptrdiff_t>(at), code_.begin() + static_cast<std::ptrdiff_t>(end),
                     is_digit);
}

RobotNumber RobotScan::number(const std::string& field, const std::string& expected) {
  peek();
  RobotNumber number;
  number.begin = at;
  number.size = number_end(at) - at;
  const std::string_view digits = std::string_view(code_).substr(number.begin, number.size);
  if (digits.empty()) {
    fail(at, field, at_end() ? "the file ends here" : fmt::format("found '{}'", shown_word({&code_[at], 1})), expected);
  }
  // 9E9 stands for an axis that does not exist in RAPID: just above what a number may be elsewhere.
  NumberProblem problem = parse_number(digits, 0, number.value);
  if (problem == NumberProblem::none && std::abs(number.value) > kLargestInput && number.value != 9e9)
    problem = NumberProblem::too_large;
  if (problem != NumberProblem::none) {
    fail(at, field, fmt::format("'{}' {}", shown_word(digits), number_problem_words(problem)), expected);
  }
  const std::size_t point = digits.find('.');
  if (point != std::string_view::npos) {
    for (std::size_t i = point + 1; i < digits.size() && is_digit(digits[i]); ++i) ++number.decimals;
  }
  at += number.size;
  return number;
}

std::size_t RobotScan::line_of(std::size_t place) const {
  // Places come in order, mostly: a long program is counted once.
  place = std::min(place, code_.size());
  if (place < counted_to_) {
    counted_to_ = 0;
    counted_lines_ = 1;
  }
  const auto at_offset = [&](std::size_t offset) { return code_.begin() + static_cast<std::ptrdiff_t>(offset); };
  counted_lines_ += static_cast<std::size_t>(std::count(at_offset(counted_to_), at_offset(place), '\n'));
  counted_to_ = place;
  return counted_lines_;
}

void RobotScan::fail(std::size_t place, const std::string& field, const std::string& problem,
                     const std::string& expected) const {
  const std::size_t before = place == 0 ? std::string::npos : code_.rfind('\n', std::min(place, code_.size()) - 1);
  const std::size_t column = place - (before == std::string::npos ? 0 : before + 1) + 1;
  throw InputError({file_, line_of(place), column, field}, problem, expected);
}

}  // namespace abbe
