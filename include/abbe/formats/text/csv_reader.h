#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/unit.h"

namespace abbe {

/// How the columns of a file that Abbe did not write are called, and which are left unread.
struct ColumnMapping {
  std::map<std::string, std::string> columns;  ///< our name with unit -> name in the file: {"C_deg", "c_deg"}
  std::vector<std::string> ignore;             ///< names in the file
  std::string ignored_by = {};  ///< how the user has a column ignored, for messages: "`ignore`"; empty: he cannot
};

/// A column that is wanted, by its base name; the header says the unit.
struct CsvColumn {
  enum class Range { any, not_negative, positive };
  std::string base;  ///< "X", "measured_x", "station"
  Quantity quantity = Quantity::dimensionless;
  bool is_text = false;  ///< a name instead of a number; no unit
  bool required = true;
  Range range = Range::any;
  bool may_be_empty = false;  ///< of a number: an empty field is read as a quiet NaN, which no field can say
  bool is_label = false;      ///< with is_text: a text of its own in every row, which may be empty
};

/// What was read of one wanted column.
struct CsvValues {
  bool present = false;
  std::string header;                ///< as in the file
  std::vector<double> numbers;       ///< [rows] mm, rad, s
  std::vector<std::uint32_t> words;  ///< [rows] index into `names`
  std::vector<std::string> names;    ///< in order of appearance
  std::vector<std::string> labels;   ///< [rows] of a label, instead of words and names
};

struct CsvTable {
  std::size_t rows = 0;
  std::vector<CsvValues> columns;  ///< as asked for
};

/// Reads comma-separated values with one header line; see docs/formats.md.
///
/// Lines that are blank or begin with # are passed over; fields may be in double quotes; byte order mark and CRLF are
/// accepted. Rows keep their order and every one of them counts or is an error. Parsed in parallel, without an
/// allocation per row; the result does not depend on the number of threads.
/// @param text  or rows of a column file as formats/readings/column_file.h has them; a row is then in line row + 2
/// @param file  name for messages
/// @throws InputError for unknown, missing and repeated columns, rows of wrong length, fields that are no number of the
///         column's unit
CsvTable read_csv(std::string_view text, const std::string& file, const std::vector<CsvColumn>& wanted,
                  const ColumnMapping& mapping = {}, int threads = 0);

/// Line of a data row (from 0), counted from 1, for messages.
std::size_t csv_line(std::string_view text, std::size_t row);
/// The same for all data rows. @return [rows]
std::vector<std::size_t> csv_lines(std::string_view text);

/// Text as a field: in quotes if it has to be.
std::string csv_field(std::string_view text);

}  // namespace abbe
