#include "abbe/formats/text/csv_number.h"

#include <fmt/format.h>

namespace abbe {

std::string csv_read_number(std::string_view field, const CsvColumn& wanted, const Unit& unit, double& value) {
  if (field.empty()) return "is empty";
  const std::string shown = field.size() > 40 ? std::string(field.substr(0, 40)) + "..." : std::string(field);
  switch (parse_quantity(field, unit, value)) {
    case NumberProblem::none:
      return csv_in_range(value, wanted.range) ? "" : fmt::format("is {}", field);
    case NumberProblem::not_a_number:
      return fmt::format("'{}' is not a number", shown);
    case NumberProblem::not_finite:
      return fmt::format("'{}' is not a finite number", shown);
    case NumberProblem::too_large:
      return fmt::format("'{}' is too large", shown);
  }
  return "";
}

std::string csv_expected_number(const CsvColumn& wanted, const Unit& unit) {
  std::string words(quantity_words(wanted.quantity));
  if (!unit.suffix.empty()) words += fmt::format(" in {}", unit.suffix);
  if (wanted.range == CsvColumn::Range::positive) words += " above zero";
  if (wanted.range == CsvColumn::Range::not_negative) words += " not below zero";
  return words;
}

}  // namespace abbe
