#include "abbe/formats/text/placed_table.h"

#include <fmt/format.h>

#include <utility>

namespace abbe {

PlacedTable::PlacedTable(std::string_view text, std::string file, const std::vector<CsvColumn>& wanted,
                         const ColumnMapping& mapping)
    : CsvTable(read_csv(text, file, wanted, mapping)), text_(text), file_(std::move(file)), is_file_(true) {}

PlacedTable::PlacedTable(const NamedColumns& given, const std::vector<CsvColumn>& wanted)
    : CsvTable(table_of_columns(given, wanted)), is_file_(false) {}

InputError::Place PlacedTable::place(std::size_t row, const std::string& field) const {
  if (!is_file_) return {.field = fmt::format("{}[{}]", field, row)};
  return {.file = file_, .line = csv_line(text_, row), .field = field};
}

std::string PlacedTable::row_words(std::size_t row) const {
  return is_file_ ? fmt::format("line {}", csv_line(text_, row)) : fmt::format("row {}", row);
}

}  // namespace abbe
