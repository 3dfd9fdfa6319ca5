#include "abbe/formats/text/calendar_date.h"

#include <fmt/format.h>

namespace abbe {

std::optional<CalendarDate> parse_calendar_date(std::string_view text) {
  constexpr std::string_view kPattern = "0000-00-00";
  if (text.size() != kPattern.size()) return std::nullopt;
  unsigned parts[3] = {};
  std::size_t part = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (kPattern[i] == '-') {
      if (text[i] != '-') return std::nullopt;
      ++part;
      continue;
    }
    if (text[i] < '0' || text[i] > '9') return std::nullopt;
    parts[part] = 10 * parts[part] + static_cast<unsigned>(text[i] - '0');
  }
  const CalendarDate date{std::chrono::year(static_cast<int>(parts[0])), std::chrono::month(parts[1]),
                          std::chrono::day(parts[2])};
  return parts[0] > 0 && date.ok() ? std::optional(date) : std::nullopt;
}

std::string calendar_date_text(const CalendarDate& date) {
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                     static_cast<unsigned>(date.day()));
}

}  // namespace abbe
