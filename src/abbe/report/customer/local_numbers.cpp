#include "abbe/report/customer/local_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace abbe {
namespace {

constexpr const char* kMinus = "\xE2\x88\x92";

bool has_decimal_comma(ReportLanguage language) { return language == ReportLanguage::german; }

std::string with_local_signs(std::string text, ReportLanguage language) {
  if (has_decimal_comma(language)) std::replace(text.begin(), text.end(), '.', ',');
  if (!text.starts_with('-')) return text;
  const bool is_zero = text.find_first_of("123456789") == std::string::npos;
  return (is_zero ? "" : kMinus) + text.substr(1);
}

bool is_number(std::string_view text) {
  if (text.starts_with(kMinus)) text.remove_prefix(3);
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  return !text.empty() && is_digit(text.front()) && is_digit(text.back()) &&
         std::all_of(text.begin(), text.end(), [&](char c) { return is_digit(c) || c == '.'; });
}

}  // namespace

std::string local_number(double value, int decimals, ReportLanguage language) {
  return with_local_signs(fmt::format("{:.{}f}", value, decimals), language);
}

std::string local_short_number(double value, ReportLanguage language) {
  return with_local_signs(fmt::format("{:.6g}", value), language);
}

std::string local_date(const CalendarDate& date, ReportLanguage language) {
  const int year = static_cast<int>(date.year());
  const unsigned month = static_cast<unsigned>(date.month()), day = static_cast<unsigned>(date.day());
  switch (language) {
    case ReportLanguage::german:
      return fmt::format("{:02}.{:02}.{:04}", day, month, year);
    case ReportLanguage::chinese:
    case ReportLanguage::japanese:
      return fmt::format("{}年{}月{}日", year, month, day);
    case ReportLanguage::english:
      break;
  }
  return calendar_date_text(date);
}

std::string local_drawing(std::string svg, ReportLanguage language) {
  if (!has_decimal_comma(language)) return svg;
  for (std::size_t at = svg.find('>'); at != std::string::npos; at = svg.find('>', at + 1)) {
    const std::size_t end = svg.find('<', at);
    if (end == std::string::npos) break;
    if (!is_number(std::string_view(svg).substr(at + 1, end - at - 1))) continue;
    std::replace(svg.begin() + static_cast<std::ptrdiff_t>(at), svg.begin() + static_cast<std::ptrdiff_t>(end), '.',
                 ',');
  }
  return svg;
}

int decimals_for(double expanded_uncertainty) {
  if (!(expanded_uncertainty > 0)) return 2;
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(expanded_uncertainty))), 0, 3);
}

}  // namespace abbe
