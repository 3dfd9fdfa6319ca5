#pragma once

#include <string>

#include "abbe/formats/study/report_facts.h"
#include "abbe/formats/text/calendar_date.h"

namespace abbe {

/// A number as readers of a language write it: decimal comma in German, else a point; U+2212 for minus; never "-0".
/// Thousands are not grouped. @param value  finite
std::string local_number(double value, int decimals, ReportLanguage language);

/// With as many decimals as it needs, six significant digits at most: for positions.
std::string local_short_number(double value, ReportLanguage language);

/// "2026-11-28", "28.11.2026", "2026年11月28日".
std::string local_date(const CalendarDate& date, ReportLanguage language);

/// A drawing whose numbers have the decimal sign of the language: texts that are nothing but a number.
std::string local_drawing(std::string svg, ReportLanguage language);

/// Decimals that show an expanded uncertainty with two significant digits, 0 to 3.
int decimals_for(double expanded_uncertainty);

}  // namespace abbe
