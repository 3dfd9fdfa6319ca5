#pragma once

// Internal to formats: a table that knows how messages name its rows.
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/named_columns.h"

namespace abbe {

/// A table from a file or from columns in memory.
class PlacedTable : public CsvTable {
 public:
  /// As read_csv(). @param text  must outlive the table
  PlacedTable(std::string_view text, std::string file, const std::vector<CsvColumn>& wanted,
              const ColumnMapping& mapping);
  /// As table_of_columns().
  PlacedTable(const NamedColumns& given, const std::vector<CsvColumn>& wanted);

  /// A whole column.
  InputError::Place place(const std::string& field) const { return {.file = file_, .field = field}; }
  /// One field of a column.
  InputError::Place place(std::size_t row, const std::string& field) const;
  /// "line 7" of a file, "row 5" of columns.
  std::string row_words(std::size_t row) const;
  bool is_file() const { return is_file_; }

 private:
  std::string_view text_;
  std::string file_;
  bool is_file_;
};

}  // namespace abbe
