#include "abbe/formats/import/exact_decimal.h"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <charconv>

#include "abbe/formats/text/ascii_letters.h"

namespace abbe {
namespace {

constexpr int kLargestExponent = 60;
constexpr std::size_t kMostDigits = 1000;

using boost::multiprecision::cpp_int;

/// A leading zero would make it octal.
cpp_int whole_number(const std::string& digits) {
  const std::size_t first = digits.find_first_not_of('0');
  return first == std::string::npos ? cpp_int(0) : cpp_int(digits.substr(first));
}

}  // namespace

std::optional<ExactDecimal> ExactDecimal::of(std::string_view text) {
  ExactDecimal number;
  std::size_t at = 0;
  if (at < text.size() && (text[at] == '-' || text[at] == '+')) number.negative_ = text[at++] == '-';
  bool fraction = false;
  for (; at < text.size() && (is_digit(text[at]) || (text[at] == '.' && !fraction)); ++at) {
    if (text[at] == '.') {
      fraction = true;
      continue;
    }
    number.digits_ += text[at];
    if (fraction) --number.exponent_;
  }
  if (number.digits_.empty() || number.digits_.size() > kMostDigits) return std::nullopt;
  if (at < text.size()) {
    if (lower_case(text[at]) != 'e') return std::nullopt;
    ++at;
    if (at < text.size() && text[at] == '+') ++at;
    int exponent = 0;
    const char* const end = text.data() + text.size();
    const auto result = std::from_chars(text.data() + at, end, exponent);
    if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
    if (exponent > kLargestExponent || exponent < -kLargestExponent) return std::nullopt;
    number.exponent_ += exponent;
  }
  return number;
}

void ExactDecimal::multiply(std::uint32_t factor) { digits_ = cpp_int(whole_number(digits_) * factor).str(); }

void ExactDecimal::align(int exponent) {
  if (exponent_ <= exponent) return;
  digits_.append(static_cast<std::size_t>(exponent_ - exponent), '0');
  exponent_ = exponent;
}

void ExactDecimal::add(const ExactDecimal& other) {
  ExactDecimal more = other;
  align(more.exponent_);
  more.align(exponent_);
  cpp_int sum = whole_number(digits_), added = whole_number(more.digits_);
  if (negative_) sum = -sum;
  sum += more.negative_ ? cpp_int(-added) : added;
  negative_ = sum < 0;
  digits_ = cpp_int(abs(sum)).str();
}

bool ExactDecimal::is_negative() const { return negative_ && digits_.find_first_not_of('0') != std::string::npos; }

std::string ExactDecimal::text() const {
  std::string digits = digits_;
  if (exponent_ > 0) digits.append(static_cast<std::size_t>(exponent_), '0');
  const std::size_t behind = exponent_ < 0 ? static_cast<std::size_t>(-exponent_) : 0;
  if (digits.size() <= behind) digits.insert(0, behind + 1 - digits.size(), '0');
  const std::size_t before = digits.size() - behind;
  const std::size_t zeros = std::min(digits.find_first_not_of('0'), before - 1);
  std::string result = (is_negative() ? "-" : "") + digits.substr(zeros, before - zeros);
  if (behind > 0) result += "." + digits.substr(before);
  return result;
}

}  // namespace abbe
