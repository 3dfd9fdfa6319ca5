#include "abbe/formats/import/foreign_number.h"

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "abbe/formats/import/exact_decimal.h"
#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/decimal_text.h"

namespace abbe {
namespace {

constexpr std::array<std::pair<std::string_view, char>, 8> kMarks = {{{"\xC2\xA0", ' '},        // no-break space
                                                                      {"\xE2\x80\xAF", ' '},    // narrow one
                                                                      {"\xE2\x80\x89", ' '},    // thin space
                                                                      {"\xE2\x80\x99", '\''},   // quotation mark
                                                                      {"\xE2\x88\x92", '-'},    // minus sign
                                                                      {"\xC2\xB0", 'o'},        // degree sign
                                                                      {"\xE2\x80\xB2", '\''},   // prime
                                                                      {"\xE2\x80\xB3", '"'}}};  // double prime

/// The character there in ASCII, and how many bytes it has; 0 for any other.
std::pair<char, std::size_t> mark_at(std::string_view text, std::size_t at) {
  if (static_cast<unsigned char>(text[at]) < 0x80U) return {text[at], 1};
  for (const auto& [written, mark] : kMarks) {
    if (text.substr(at).starts_with(written)) return {mark, written.size()};
  }
  return {'\0', 1};
}

ThousandsMark thousands_of(char mark) {
  switch (mark) {
    case ',':
      return ThousandsMark::comma;
    case '.':
      return ThousandsMark::point;
    case ' ':
      return ThousandsMark::blank;
    case '\'':
      return ThousandsMark::apostrophe;
    default:
      return ThousandsMark::none;
  }
}

/// Digits in groups, and the marks between them.
struct DigitGroups {
  static constexpr std::size_t kMost = 12;
  std::array<std::size_t, kMost> digits{};
  std::array<char, kMost> marks{};  // marks[i] stands before group i + 1
  std::size_t count = 1;
  bool begins_with_zero = false, has_exponent = false;
};

/// @returns whether the rest of the field is the exponent of a number
bool is_exponent(std::string_view rest) {
  rest.remove_prefix(1);
  if (!rest.empty() && (rest.front() == '-' || rest.front() == '+')) rest.remove_prefix(1);
  return !rest.empty() && rest.find_first_not_of("0123456789") == std::string_view::npos;
}

std::optional<DigitGroups> digit_groups(std::string_view field) {
  DigitGroups groups;
  std::size_t at = 0;
  if (!field.empty()) {
    const auto [sign, length] = mark_at(field, 0);
    if (sign == '-' || sign == '+') at = length;
  }
  const std::size_t begin = at;
  while (at < field.size()) {
    const auto [c, length] = mark_at(field, at);
    if (is_digit(c)) {
      if (at == begin) groups.begins_with_zero = c == '0';
      ++groups.digits[groups.count - 1];
    } else if (c == 'e' || c == 'E' || c == 'd' || c == 'D') {
      if (!is_exponent(field.substr(at))) return std::nullopt;
      groups.has_exponent = true;
      break;
    } else if (thousands_of(c) != ThousandsMark::none && groups.count < DigitGroups::kMost) {
      groups.marks[groups.count - 1] = c;
      ++groups.count;
    } else {
      return std::nullopt;
    }
    at += length;
  }
  std::size_t digits = 0;
  for (std::size_t i = 0; i < groups.count; ++i) digits += groups.digits[i];
  if (digits == 0) return std::nullopt;
  return groups;
}

/// Whether the first `count` groups are thousands: one to three digits, then three each.
bool are_thousands(const DigitGroups& groups, std::size_t count) {
  if (groups.digits[0] < 1 || groups.digits[0] > 3) return false;
  for (std::size_t i = 1; i < count; ++i) {
    if (groups.digits[i] != 3 || groups.marks[i - 1] != groups.marks[0]) return false;
  }
  return true;
}

bool is_below_60(std::string_view part) {
  const std::string_view whole = part.substr(0, part.find('.'));
  return whole.size() == 1 || (whole.size() == 2 && whole[0] < '6');
}

}  // namespace

NumberMarks marks_of_number(std::string_view field) {
  const std::optional<DigitGroups> found = digit_groups(field);
  if (!found) return {};
  const DigitGroups& groups = *found;
  if (groups.count == 1) return {MarkEvidence::none, ThousandsMark::none};
  const char last = groups.marks[groups.count - 2];
  const bool is_decimal = last == '.' || last == ',';
  const MarkEvidence by_decimal = last == '.' ? MarkEvidence::point : MarkEvidence::comma;
  if (groups.count == 2 && is_decimal) {
    const bool may_be_thousands = are_thousands(groups, 2) && !groups.begins_with_zero && !groups.has_exponent;
    if (!may_be_thousands) return {by_decimal, ThousandsMark::none};
    return {last == '.' ? MarkEvidence::point_or_thousands : MarkEvidence::comma_or_thousands, ThousandsMark::none};
  }
  const char first = groups.marks[0];
  const ThousandsMark thousands = thousands_of(first);
  if (first != last) {
    if (!is_decimal || !are_thousands(groups, groups.count - 1)) return {};
    return {by_decimal, thousands};
  }
  if (!are_thousands(groups, groups.count)) return {};
  if (!is_decimal) return {MarkEvidence::none, thousands};
  return {last == '.' ? MarkEvidence::comma : MarkEvidence::point, thousands};
}

std::string_view plain_number(std::string_view field, const NumberNotation& notation, std::string& buffer) {
  if (notation.decimal == DecimalMark::point) {
    double ignored = 0;
    const char* const end = field.data() + field.size();
    if (!field.empty() && read_short_decimal(field.data(), end, 0, ignored) == end) return field;
  }
  buffer.clear();
  const char decimal = notation.decimal == DecimalMark::point ? '.' : ',';
  std::size_t group = 0, groups = 0, digits = 0;
  bool fraction = false;
  for (std::size_t at = 0; at < field.size();) {
    const auto [c, length] = mark_at(field, at);
    if (is_digit(c)) {
      buffer += c;
      ++digits;
      ++group;
    } else if ((c == '-' || c == '+') && at == 0) {
      if (c == '-') buffer += c;
    } else if (c == decimal && !fraction) {
      if (groups > 0 && group != 3) return {};
      buffer += '.';
      fraction = true;
    } else if (!fraction && notation.thousands != ThousandsMark::none && thousands_of(c) == notation.thousands) {
      if (groups == 0 ? group < 1 || group > 3 : group != 3) return {};
      ++groups;
      group = 0;
    } else if (c == 'e' || c == 'E' || c == 'd' || c == 'D') {
      if (digits == 0 || !is_exponent(field.substr(at)) || (!fraction && groups > 0 && group != 3)) return {};
      buffer += 'e';
      buffer += field.substr(at + 1);
      return buffer;
    } else {
      return {};
    }
    at += length;
  }
  if (digits == 0 || (!fraction && groups > 0 && group != 3)) return {};
  return buffer;
}

bool is_sexagesimal(std::string_view field) {
  std::string ignored;
  return !sexagesimal_arcseconds(field, DecimalMark::point, ignored).empty() ||
         !sexagesimal_arcseconds(field, DecimalMark::comma, ignored).empty();
}

std::string_view sexagesimal_arcseconds(std::string_view field, DecimalMark decimal, std::string& buffer) {
  std::array<std::string, 3> parts;  // degrees, minutes, seconds
  const char point = decimal == DecimalMark::point ? '.' : ',';
  std::size_t part = 0;
  bool negative = false, closed = false, fraction = false, colons = false;
  for (std::size_t at = 0; at < field.size();) {
    const auto [c, length] = mark_at(field, at);
    if (at == 0 && (c == '-' || c == '+')) {
      negative = c == '-';
    } else if (is_digit(c) && !closed && part < 3 && parts[part].size() < 40) {
      parts[part] += c;
    } else if (c == point && !closed && part < 3 && part > 0 && !fraction && !parts[part].empty()) {
      parts[part] += '.';
      fraction = true;
    } else if (part < 3 && !parts[part].empty() && !fraction && c == ':' && part < 2) {
      colons = true;
      ++part;
    } else if (part < 3 && !parts[part].empty() && !colons &&
               ((c == 'o' && length == 2 && part == 0) || (c == '\'' && part == 1) || (c == '"' && part == 2))) {
      closed = fraction;
      ++part;
    } else if (c != ' ' || colons) {
      return {};
    }
    at += length;
  }
  const bool has_mark = colons ? part == 2 : part >= 2 || (part == 1 && !parts[1].empty());
  if (!has_mark || parts[0].empty() || (colons && parts[2].empty())) return {};
  for (std::size_t i = 1; i < 3; ++i) {
    if (parts[i].empty()) parts[i] = "0";
    if (!is_below_60(parts[i])) return {};
  }
  std::optional<ExactDecimal> arcseconds = ExactDecimal::of(parts[0]);
  const std::optional<ExactDecimal> minutes = ExactDecimal::of(parts[1]), seconds = ExactDecimal::of(parts[2]);
  if (!arcseconds || !minutes || !seconds) return {};
  ExactDecimal sum = *arcseconds;
  sum.multiply(60);
  sum.add(*minutes);
  sum.multiply(60);
  sum.add(*seconds);
  if (negative) sum.negate();
  buffer = sum.text();
  return buffer;
}

}  // namespace abbe
