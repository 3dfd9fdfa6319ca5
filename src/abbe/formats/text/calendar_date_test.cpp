#include "abbe/formats/text/calendar_date.h"

#include <gtest/gtest.h>

namespace abbe {
namespace {

TEST(ParseCalendarDate, TakesDaysOfTheCalendarOnly) {
  using std::chrono::year;
  EXPECT_EQ(parse_calendar_date("2024-02-29"), year{2024} / 2 / 29);
  for (const char* text : {"", "2026-2-03", "2026-02-30", "2026-13-01", "2026-00-10", "0000-01-01", "2026/01/01",
                           "2026-01-01 ", "-026-01-01", "２０２６"}) {
    EXPECT_FALSE(parse_calendar_date(text)) << text;
  }
}

TEST(CalendarDateText, IsReadBack) {
  for (const char* text : {"0001-01-01", "2026-03-02", "9999-12-31"}) {
    EXPECT_EQ(calendar_date_text(*parse_calendar_date(text)), text);
  }
}

}  // namespace
}  // namespace abbe
