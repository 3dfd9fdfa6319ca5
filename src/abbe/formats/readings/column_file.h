#pragma once

// Internal to formats: files of readings by columns, Parquet and Arrow IPC.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "abbe/formats/readings/column_reader.h"
#include "abbe/formats/readings/instrument_file.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {

/// Whether a file begins as a Parquet or Arrow IPC file does, or its name says that it is one. False if it cannot be
/// read.
bool is_column_file(const std::filesystem::path& path);

/// The rows of a column file, without the columns that a mapping ignores.
class ColumnFile {
 public:
  /// @param number  of the file among those of the reader
  /// @throws InputError as the reader does
  ColumnFile(std::shared_ptr<ColumnReader> reader, std::size_t number, const ColumnMapping& mapping);

  const std::filesystem::path& path() const { return reader_->file(number_); }
  std::size_t rows() const { return rows_; }
  /// Rows first .. last - 1, as read_csv() takes them in place of text. Thread-safe. @throws InputError
  std::string read(std::size_t first, std::size_t last) const;

 private:
  std::shared_ptr<ColumnReader> reader_;
  std::size_t number_;
  std::size_t rows_ = 0;
  std::vector<std::size_t> columns_;
};

/// The error with the row in place of the line: read_csv() counts the first row of a block as line 2.
/// @param first  number of the first row of the block
InputError at_row_of_columns(const InputError& error, std::size_t first);

}  // namespace abbe
