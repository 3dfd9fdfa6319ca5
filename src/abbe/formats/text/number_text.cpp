#include "abbe/formats/text/number_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "abbe/formats/text/appended_number.h"
#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/not_finite.h"

namespace abbe {
namespace {

// All exact in double: 5^22 < 2^53.
constexpr std::array<double, 23> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                                 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr std::uint64_t kLargestExactInteger = std::uint64_t{1} << 53;
constexpr int kFullWord = 19;  // decimal digits that always fit in 64 bits

/// Parts of a decimal number: sign, digits as integer (if few enough) and the power of ten that goes with it.
struct Decimal {
  bool negative = false;
  bool fits = true;  // `digits` is exact
  std::uint64_t digits = 0;
  long exponent = 0;          // of ten, belongs to `digits`
  std::string_view mantissa;  // as written, without sign and exponent
  long written_exponent = 0;
  long significant = 0;  // digits, from the first that is not zero
};

bool split(std::string_view text, Decimal& decimal) {
  const char* at = text.data();
  const char* const end = at + text.size();
  if (at != end && (*at == '-' || *at == '+')) decimal.negative = *at++ == '-';
  const char* const mantissa = at;
  int significant = 0;
  long fraction = 0;
  bool any = false;
  const auto take = [&](char c) {
    any = true;
    if (significant == 0 && c == '0') return;
    if (++significant <= kFullWord) decimal.digits = decimal.digits * 10 + static_cast<std::uint64_t>(c - '0');
  };
  for (; at != end && is_digit(*at); ++at) take(*at);
  if (at != end && *at == '.') {
    for (++at; at != end && is_digit(*at); ++at, ++fraction) take(*at);
  }
  if (!any) return false;
  decimal.fits = significant <= kFullWord;
  decimal.significant = significant;
  decimal.mantissa = {mantissa, static_cast<std::size_t>(at - mantissa)};
  if (at != end && (*at == 'e' || *at == 'E')) {
    ++at;
    bool negative = false;
    if (at != end && (*at == '-' || *at == '+')) negative = *at++ == '-';
    if (at == end) return false;
    long exponent = 0;
    for (; at != end && is_digit(*at); ++at) exponent = exponent < 100000 ? exponent * 10 + (*at - '0') : exponent;
    decimal.written_exponent = negative ? -exponent : exponent;
  }
  decimal.exponent = decimal.written_exponent - fraction;
  return at == end;
}

/// Any number of digits, by the standard library; the shift goes into the exponent as text.
std::from_chars_result parse_long_way(const Decimal& decimal, int decimal_shift, double& value) {
  std::array<char, 64> buffer;
  const std::string exponent = "e" + std::to_string(decimal.written_exponent + decimal_shift);
  const std::size_t length = decimal.mantissa.size() + exponent.size();
  if (length <= buffer.size()) {
    const auto behind = std::copy(decimal.mantissa.begin(), decimal.mantissa.end(), buffer.begin());
    std::copy(exponent.begin(), exponent.end(), behind);
    return std::from_chars(buffer.data(), buffer.data() + length, value);
  }
  const std::string plain = std::string(decimal.mantissa) + exponent;
  return std::from_chars(plain.data(), plain.data() + plain.size(), value);
}

bool is_not_finite_word(std::string_view text) {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  const auto equals = [&](std::string_view word) {
    if (text.size() != word.size()) return false;
    for (std::size_t i = 0; i < word.size(); ++i) {
      if ((text[i] | 0x20) != word[i]) return false;
    }
    return true;
  };
  return equals("nan") || equals("inf") || equals("infinity");
}

}  // namespace

NumberProblem parse_number(std::string_view text, int decimal_shift, double& value) {
  Decimal decimal;
  if (!split(text, decimal)) {
    return is_not_finite_word(text) ? NumberProblem::not_finite : NumberProblem::not_a_number;
  }
  const long exponent = decimal.exponent + decimal_shift;
  // One correctly rounded operation on two exact numbers (Clinger 1990).
  if (decimal.fits && decimal.digits <= kLargestExactInteger && exponent >= -22 && exponent <= 22) {
    const double digits = static_cast<double>(decimal.digits);
    value = exponent < 0 ? digits / kPowersOfTen[static_cast<std::size_t>(-exponent)]
                         : digits * kPowersOfTen[static_cast<std::size_t>(exponent)];
  } else {
    const auto result = parse_long_way(decimal, decimal_shift, value);
    if (result.ec == std::errc::result_out_of_range) {
      if (decimal.significant + exponent > 0) return NumberProblem::too_large;
      value = 0;
    } else if (result.ec != std::errc()) {
      return NumberProblem::not_a_number;
    }
  }
  if (decimal.negative) value = -value;
  return NumberProblem::none;
}

void append_shortest_text(double value, int decimal_shift, std::string& out) {
  if (!std::isfinite(value)) throw NotFinite("a number to be written");
  if (std::signbit(value)) out += '-';
  if (value == 0) {
    out += '0';
    return;
  }
  std::array<char, 32> digits;  // d.ddde+dd
  // In this range the standard library writes the same text, and is faster.
  if (decimal_shift == 0 && std::abs(value) >= 1e-4 && std::abs(value) < 1e15) {
    const auto plain =
        std::to_chars(digits.data(), digits.data() + digits.size(), std::abs(value), std::chars_format::fixed);
    out.append(digits.data(), plain.ptr);
    return;
  }
  const auto written =
      std::to_chars(digits.data(), digits.data() + digits.size(), std::abs(value), std::chars_format::scientific);
  const std::string_view text(digits.data(), static_cast<std::size_t>(written.ptr - digits.data()));
  const std::size_t mark = text.find('e');
  long exponent = 0;
  const char* first = text.data() + mark + 1;
  if (*first == '+') ++first;
  std::from_chars(first, text.data() + text.size(), exponent);
  exponent += decimal_shift;
  // The digits without the point, which is the second character if there are several digits.
  if (mark > 1) digits[1] = digits[0];
  const std::string_view all = mark > 1 ? text.substr(1, mark - 1) : text.substr(0, 1);
  const long count = static_cast<long>(all.size());
  if (exponent < -5 || exponent > 16) {
    out += all.front();
    if (count > 1) (out += '.') += all.substr(1);
    (out += 'e') += std::to_string(exponent);
  } else if (exponent < 0) {
    (out += "0.").append(static_cast<std::size_t>(-exponent - 1), '0') += all;
  } else if (exponent >= count - 1) {
    (out += all).append(static_cast<std::size_t>(exponent - count + 1), '0');
  } else {
    const auto point = static_cast<std::size_t>(exponent) + 1;
    ((out += all.substr(0, point)) += '.') += all.substr(point);
  }
}

std::string shortest_text(double value, int decimal_shift) {
  std::string out;
  append_shortest_text(value, decimal_shift, out);
  return out;
}

}  // namespace abbe
