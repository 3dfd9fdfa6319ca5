#pragma once

// Internal to formats: the columns of a mapping, found in a file and ready to be read.
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/formats/import/foreign_number.h"
#include "abbe/formats/import/foreign_unit.h"
#include "abbe/formats/import/import_mapping.h"

namespace abbe {

/// A column of the file and what becomes of its fields.
struct ColumnSource {
  std::size_t source = 0;  ///< from 0
  std::string name;        ///< in the file, for messages
  ImportColumn::Holds holds = ImportColumn::Holds::number;
  const ForeignUnit* unit = nullptr;  ///< null: none
  ImportConvention convention = ImportConvention::as_written;
  std::vector<std::string> positive, negative;

  /// Whether the digits of a number change.
  bool is_converted() const {
    return convention != ImportConvention::as_written ||
           (unit != nullptr && (unit->factor != 1 || unit->shift != 0 || unit->sexagesimal));
  }
};

/// @throws InputError as imported_rows() for the mapping and the header
std::vector<ColumnSource> column_sources(const std::string& file, const FoundLayout& found,
                                         const ImportMapping& mapping, const std::vector<ImportColumn>& wanted);

/// Writes a field as Abbe reads it. @returns what is wrong with it, in words, or nothing; then `expected` too
std::string append_imported(std::string_view field, const ColumnSource& column, const NumberNotation& notation,
                            std::string& buffer, std::string& out, std::string& expected);

}  // namespace abbe
