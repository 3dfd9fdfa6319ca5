#pragma once

// Internal to formats: numbers as other programs write them.
#include <string>
#include <string_view>

#include "abbe/formats/import/table_layout.h"

namespace abbe {

/// What the marks between the digits of a field tell about the decimal mark.
enum class MarkEvidence {
  not_a_number,
  none,                ///< no mark, or one that cannot be the decimal mark
  point,               ///< "12.5", "1,234.5", "1,234,567"
  comma,               ///< "12,5", "1.234,5", "1.234.567"
  point_or_thousands,  ///< "1.234"
  comma_or_thousands   ///< "1,234"
};

struct NumberMarks {
  MarkEvidence evidence = MarkEvidence::not_a_number;
  ThousandsMark thousands = ThousandsMark::none;  ///< certain of itself: "1'234", "1.234,5"
};

/// Looks at a field that may be a number in any notation: digits with marks, a sign and an exponent. Only a minus sign
/// of typography (U+2212), no-break and thin spaces are more than ASCII.
NumberMarks marks_of_number(std::string_view field);

struct NumberNotation {
  DecimalMark decimal = DecimalMark::point;
  ThousandsMark thousands = ThousandsMark::none;
};

/// A number as Abbe reads it, with the same digits: the field itself, or its text in `buffer`; empty if it is none.
std::string_view plain_number(std::string_view field, const NumberNotation& notation, std::string& buffer);

/// Whether a field is an angle in degrees, minutes and seconds: 12°34'56.7", 12:34:56.7.
bool is_sexagesimal(std::string_view field);

/// Such an angle in arcseconds, exact; empty if it is none. Minutes and seconds are below 60.
std::string_view sexagesimal_arcseconds(std::string_view field, DecimalMark decimal, std::string& buffer);

}  // namespace abbe
