#include "abbe/formats/import/exact_decimal.h"

#include <algorithm>
#include <charconv>

#include "abbe/formats/text/ascii_letters.h"

namespace abbe {
namespace {

constexpr int kLargestExponent = 60;

/// Both of the same length: a plus b.
std::string sum_of_digits(std::string a, std::string_view b) {
  int carry = 0;
  for (std::size_t i = a.size(); i-- > 0;) {
    const int digit = (a[i] - '0') + (b[i] - '0') + carry;
    a[i] = static_cast<char>('0' + digit % 10);
    carry = digit / 10;
  }
  if (carry > 0) a.insert(a.begin(), static_cast<char>('0' + carry));
  return a;
}

/// Both of the same length, a not below b: a minus b.
std::string difference_of_digits(std::string a, std::string_view b) {
  int borrowed = 0;
  for (std::size_t i = a.size(); i-- > 0;) {
    int digit = (a[i] - '0') - (b[i] - '0') - borrowed;
    borrowed = digit < 0 ? 1 : 0;
    if (digit < 0) digit += 10;
    a[i] = static_cast<char>('0' + digit);
  }
  return a;
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
  if (number.digits_.empty()) return std::nullopt;
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

void ExactDecimal::multiply(std::uint32_t factor) {
  std::uint64_t carry = 0;
  for (std::size_t i = digits_.size(); i-- > 0;) {
    carry += static_cast<std::uint64_t>(digits_[i] - '0') * factor;
    digits_[i] = static_cast<char>('0' + carry % 10);
    carry /= 10;
  }
  for (; carry > 0; carry /= 10) digits_.insert(digits_.begin(), static_cast<char>('0' + carry % 10));
}

void ExactDecimal::align(int exponent) {
  if (exponent_ <= exponent) return;
  digits_.append(static_cast<std::size_t>(exponent_ - exponent), '0');
  exponent_ = exponent;
}

void ExactDecimal::add(const ExactDecimal& other) {
  ExactDecimal more = other;
  align(more.exponent_);
  more.align(exponent_);
  const std::size_t length = std::max(digits_.size(), more.digits_.size());
  digits_.insert(0, length - digits_.size(), '0');
  more.digits_.insert(0, length - more.digits_.size(), '0');
  if (negative_ == more.negative_) {
    digits_ = sum_of_digits(digits_, more.digits_);
  } else if (digits_ >= more.digits_) {
    digits_ = difference_of_digits(digits_, more.digits_);
  } else {
    digits_ = difference_of_digits(more.digits_, digits_);
    negative_ = more.negative_;
  }
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
