#pragma once

// Internal to formats: rows of a column file (Parquet, Arrow IPC) as bytes, which read_csv() takes in place of text.
//
// All numbers are of 8 bytes, in the byte order of the machine: the mark "\0columns", the number of rows, the number of
// columns. Of each column its name and its kind (a number of bytes and so many bytes each), and 1 byte, 1 if its values
// follow. Then the values of these columns, one after the other:
//
// - kinds "float" and "integer": 1 byte, 1 if no value is missing; where one is, of each row 1 byte, 1 if it is there;
//   of each row a double;
// - kind "text": of each row where its text begins, and where the last one ends; the texts.
//
// Other kinds, which have no values, are types that Abbe does not read.
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/csv_reader.h"

namespace abbe {

struct ColumnOfBlock {
  std::string name;
  std::string kind;
  bool is_read = false;  ///< its values follow
};

struct ColumnBlockHead {
  std::size_t rows = 0;
  std::vector<ColumnOfBlock> columns;
  std::size_t values_at = 0;  ///< byte
};

bool is_column_block(std::string_view text);

/// @throws InputError if it is cut off or damaged
ColumnBlockHead column_block_head(std::string_view block, const std::string& file);

/// As read_csv(), with the same values as from the CSV file whose numbers have the fewest digits that tell them apart.
/// In errors, line 2 is the first row of the block.
CsvTable read_column_block(std::string_view block, const std::string& file, const std::vector<CsvColumn>& wanted,
                           const ColumnMapping& mapping, int threads);

}  // namespace abbe
