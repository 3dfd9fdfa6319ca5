#include "abbe/formats/text/named_columns.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>

#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/csv_number.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

std::size_t column_rows(const NamedColumn& column) {
  return std::visit([](const auto& values) { return values.size(); }, column.values);
}

std::vector<CsvFileColumn> matched_columns(const NamedColumns& columns, const std::vector<CsvColumn>& wanted) {
  std::string header;
  for (const NamedColumn& column : columns) header += (header.empty() ? "" : ",") + csv_field(column.name);
  try {
    return csv_match_header(header, "", 0, wanted, {});
  } catch (const InputError& error) {
    // Without a file there is no line or character to name.
    throw InputError({.field = error.place().field}, error.problem(), error.expected());
  }
}

std::string column_field(const NamedColumn& column, std::size_t row) { return fmt::format("{}[{}]", column.name, row); }

/// As a file would state it.
std::string column_text(double number) {
  return std::isfinite(number) ? shortest_text(number) : fmt::format("{}", number);
}

void enter_numbers(const NamedColumn& column, const CsvColumn& wanted, const Unit& unit, CsvValues& values) {
  const auto* const numbers = std::get_if<std::vector<double>>(&column.values);
  if (!numbers)
    throw InputError({.field = column.name}, "is not an array of numbers", csv_expected_number(wanted, unit));
  values.numbers.resize(numbers->size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t row = 0; row < numbers->size(); ++row) {
    if (wanted.may_be_empty && std::isnan((*numbers)[row])) continue;
    // Through text, so that 2.5 um becomes the same number of mm as from a file.
    const std::string problem = csv_read_number(column_text((*numbers)[row]), wanted, unit, values.numbers[row]);
    if (!problem.empty())
      throw InputError({.field = column_field(column, row)}, problem, csv_expected_number(wanted, unit));
  }
}

std::string column_word(const NamedColumn& column, std::size_t row) {
  if (const auto* const words = std::get_if<std::vector<std::string>>(&column.values)) {
    return std::string(csv_trimmed((*words)[row]));
  }
  return column_text(std::get<std::vector<double>>(column.values)[row]);
}

void enter_words(const NamedColumn& column, CsvValues& values) {
  std::map<std::string, std::uint32_t> index;
  for (std::size_t row = 0; row < column_rows(column); ++row) {
    const std::string word = column_word(column, row);
    if (word.empty()) throw InputError({.field = column_field(column, row)}, "is empty", "a name");
    const auto [entry, is_new] = index.emplace(word, static_cast<std::uint32_t>(values.names.size()));
    if (is_new) values.names.push_back(word);
    if (values.names.size() > kLargestNameCount) {
      throw InputError({.field = column_field(column, row)}, "too many different names",
                       fmt::format("at most {}", kLargestNameCount));
    }
    values.words.push_back(entry->second);
  }
}

}  // namespace

CsvTable table_of_columns(const NamedColumns& columns, const std::vector<CsvColumn>& wanted) {
  if (columns.empty()) throw InputError({}, "there are no columns", "columns named as in a file");
  const std::vector<CsvFileColumn> matches = matched_columns(columns, wanted);
  CsvTable table;
  table.rows = column_rows(columns.front());
  table.columns.resize(wanted.size());
  for (const NamedColumn& column : columns) {
    if (column_rows(column) == table.rows) continue;
    throw InputError({.field = column.name},
                     fmt::format("has {} value{}", column_rows(column), column_rows(column) == 1 ? "" : "s"),
                     fmt::format("{} as in {}", table.rows, columns.front().name));
  }
  if (table.rows == 0) throw InputError({.field = columns.front().name}, "there are no rows", "at least one row");
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const CsvColumn& want = wanted[matches[i].wanted];
    CsvValues& values = table.columns[matches[i].wanted];
    values.present = true;
    values.header = columns[i].name;
    if (want.is_text) {
      enter_words(columns[i], values);
    } else {
      enter_numbers(columns[i], want, *matches[i].unit, values);
    }
  }
  return table;
}

}  // namespace abbe
