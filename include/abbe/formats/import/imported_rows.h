#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "abbe/formats/import/import_mapping.h"
#include "abbe/formats/import/table_layout.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Rows of a table as Abbe reads them.
struct ImportedRows {
  std::string csv;  ///< header and rows
  std::size_t rows = 0;
  std::size_t blank_lines = 0;    ///< below the first row; lines of nothing but separators too
  std::size_t comment_lines = 0;  ///< likewise
};

/// Converts all rows of a table. Numbers that need no conversion keep their digits; inches, gon, minutes of arc, zenith
/// angles in decimal units and reversed signs are exact in decimal. Rows keep their order, and every one of them counts
/// or is an error.
/// @param found    layout and header of the file
/// @param machine  of a tracker's commands; not used by other kinds
/// @param threads  0: all; the result does not depend on it
/// @throws InputError for columns that the file or the kind does not have, a unit that the file contradicts, rows of
///   another length, and fields that are no number, name or direction, with line and column
ImportedRows imported_rows(std::string_view text, const std::string& file, const FoundLayout& found,
                           const ImportMapping& mapping, const Machine& machine, int threads = 0);

/// Line in the file, from 1, of a row, from 0.
std::size_t imported_line(std::string_view text, const TableLayout& layout, std::size_t row);

}  // namespace abbe
