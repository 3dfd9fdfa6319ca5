#pragma once

// Internal to formats: a CSV text read in runs of lines, for files that are not to be kept in memory.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/text_blocks.h"

namespace abbe {

/// Header of a CSV text, matched with what is wanted; reads any run of its lines. See read_csv() for the format.
class CsvRows {
 public:
  /// @param text  must outlive the object
  /// @throws InputError as read_csv() for the header
  CsvRows(std::string_view text, std::string file, std::vector<CsvColumn> wanted, const ColumnMapping& mapping = {});

  std::string_view text() const { return text_; }  ///< without a byte order mark
  const std::string& file() const { return file_; }
  std::size_t first() const { return first_; }  ///< byte of the first line below the header
  const std::vector<CsvColumn>& wanted() const { return wanted_; }
  const std::vector<CsvFileColumn>& columns() const { return columns_; }

  /// Reads the lines from `begin` to `end` on the calling thread; several threads may read at a time.
  /// @param table  overwritten; its memory is used again. Words are numbered within the run
  /// @returns what was refused first
  std::optional<TextRefusal> read(std::size_t begin, std::size_t end, CsvTable& table) const;

  /// Rows of a run of lines, which are not looked into.
  std::size_t count(std::size_t begin, std::size_t end) const;

  /// Byte where a row of a run begins that read() gave.
  std::size_t row_offset(std::size_t begin, std::size_t row) const;

 private:
  std::string_view text_;
  std::string file_;
  std::size_t first_ = 0;
  std::vector<CsvColumn> wanted_;
  std::vector<CsvFileColumn> columns_;
};

}  // namespace abbe
