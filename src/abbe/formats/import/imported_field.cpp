#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/formats/import/column_source.h"
#include "abbe/formats/import/exact_decimal.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/utf8.h"

namespace abbe {
namespace {

std::string shown_field(std::string_view field) { return printable(field, 40, LineFeeds::escaped); }

/// A quarter turn in a unit that Abbe reads; exact where it is a whole number.
double quarter_turn(const ForeignUnit& unit) {
  if (unit.suffix == "deg") return 90;
  if (unit.suffix == "arcsec") return 324000;
  return std::numbers::pi / 2 * std::pow(10.0, -unit_named(Quantity::angle, unit.suffix).decimal_shift);
}

/// The value of a number in the unit of the file, in the unit that is written, exact in decimal where it can be.
std::string converted(std::string_view plain, const ColumnSource& column) {
  const bool reversed = column.convention != ImportConvention::as_written;
  const bool zenith = column.convention == ImportConvention::zenith;
  const double quarter = zenith ? quarter_turn(*column.unit) : 0;
  std::optional<ExactDecimal> number = ExactDecimal::of(plain);
  if (!number || quarter != std::floor(quarter)) {
    double value = 0;
    parse_number(plain, column.unit == nullptr ? 0 : column.unit->shift, value);
    if (column.unit != nullptr) value *= column.unit->factor;
    return shortest_text(reversed ? quarter - value : value);
  }
  if (column.unit != nullptr) {
    number->multiply(column.unit->factor);
    number->shift(column.unit->shift);
  }
  if (reversed) number->negate();
  if (zenith) number->add(*ExactDecimal::of(fmt::format("{}", quarter)));
  return number->text();
}

bool has_word(const std::vector<std::string>& words, std::string_view field) {
  return std::find(words.begin(), words.end(), field) != words.end();
}

std::string append_direction(std::string_view field, const ColumnSource& column, std::string& out,
                             std::string& expected) {
  const bool rotation = column.holds == ImportColumn::Holds::rotation;
  const std::string_view plus = rotation ? "ccw" : "+", minus = rotation ? "cw" : "-";
  const bool usual = column.positive.empty() && column.negative.empty();
  const auto is_usual = [&](std::string_view own, std::string_view word) {
    return field == own || (!rotation && field == word);
  };
  const bool positive = usual ? is_usual(plus, "positive") : has_word(column.positive, field);
  if (!positive && !(usual ? is_usual(minus, "negative") : has_word(column.negative, field))) {
    expected = usual ? fmt::format("{} or {}", plus, minus)
                     : fmt::format("{} for {}, {} for {}", fmt::join(column.positive, ", "), plus,
                                   fmt::join(column.negative, ", "), minus);
    return fmt::format("'{}' is not a direction", shown_field(field));
  }
  out += positive ? plus : minus;
  return "";
}

}  // namespace

std::string append_imported(std::string_view field, const ColumnSource& column, const NumberNotation& notation,
                            std::string& buffer, std::string& out, std::string& expected) {
  switch (column.holds) {
    case ImportColumn::Holds::direction:
    case ImportColumn::Holds::rotation:
      return append_direction(field, column, out, expected);
    case ImportColumn::Holds::name:
      if (field.empty()) {
        expected = "a name";
        return "is empty";
      }
      [[fallthrough]];
    case ImportColumn::Holds::label:
      out += csv_field(field);
      return "";
    case ImportColumn::Holds::number:
      break;
  }
  const bool sexagesimal = column.unit != nullptr && column.unit->sexagesimal;
  const std::string_view plain =
      sexagesimal ? sexagesimal_arcseconds(field, notation.decimal, buffer) : plain_number(field, notation, buffer);
  if (plain.empty()) {
    expected = sexagesimal ? "an angle in degrees, minutes and seconds"
                           : fmt::format("a number with a decimal {}", decimal_name(notation.decimal));
    return field.empty() ? "is empty" : fmt::format("'{}' is not a number", shown_field(field));
  }
  double value = 0;
  if (parse_number(plain, 0, value) != NumberProblem::none || std::abs(value) > kLargestInput) {
    expected = fmt::format("a number of at most {:g}", kLargestInput);
    return fmt::format("'{}' is too large", shown_field(field));
  }
  if (column.convention == ImportConvention::zenith) {
    const double quarter = quarter_turn(*column.unit);
    const double angle = value * column.unit->factor * std::pow(10.0, column.unit->shift);
    if (angle < 0 || angle > 2 * quarter) {
      expected = "an angle from the zenith, of 0 to 180 degrees";
      return fmt::format("'{}' is out of range", shown_field(field));
    }
  }
  if (column.is_converted()) {
    out += converted(plain, column);
  } else {
    out += plain;
  }
  return "";
}

}  // namespace abbe
