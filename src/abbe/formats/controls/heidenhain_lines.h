#pragma once

// Internal to formats: what the tables of a HEIDENHAIN control have in common. A table begins with "BEGIN name MM" and
// the names of its columns, has a row per line, numbered from 0, and ends with "[END]".
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/table_numbers.h"

namespace abbe {

/// mm with 6 decimals; of rotary axes rad as degrees with 7.
std::string heidenhain_number(double value, bool rotary);

/// Rows of a table that is read.
class HeidenhainLines {
 public:
  /// Stands at the line with the names of the columns then.
  /// @param begin    the first line, as an error states what was expected: "BEGIN name.COM MM"
  /// @param columns  the same of the second line
  /// @throws InputError if the text does not begin so
  HeidenhainLines(std::string_view text, const std::string& file, const char* begin, const char* columns);

  /// To the next row; empty lines are passed. @returns false at the end of the text
  /// @throws InputError for anything behind [END]
  bool next();
  /// Of the row: checks that it is the next one. @param rows_at_most  for which the control has room
  void check_number(std::string_view word, std::size_t row, std::size_t rows_at_most) const;
  /// After the last row. @throws InputError if there is no [END], or no row
  void check_end(std::size_t rows) const;

  const TableLines& lines() const { return lines_; }
  std::string_view line() const { return lines_.line(); }

 private:
  const std::string& file_;
  TableLines lines_;
  bool ended_ = false;
};

}  // namespace abbe
