#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace abbe {

/// A day of the Gregorian calendar.
using CalendarDate = std::chrono::year_month_day;

/// Reads a date as files and options write it, "2026-03-02" (ISO 8601, years 1 to 9999).
/// @return nothing for any other text, and for a day that the calendar does not have
std::optional<CalendarDate> parse_calendar_date(std::string_view text);

/// "2026-03-02".
std::string calendar_date_text(const CalendarDate& date);

}  // namespace abbe
