#pragma once

// Internal to formats: the process that reads column files.
#include <sys/types.h>

#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "abbe/formats/files/child_process.h"

namespace abbe {

/// The variable of the environment that names a Python with pyarrow; without it that is the python3 of the PATH.
inline constexpr const char* kColumnsPython = "ABBE_COLUMNS_PYTHON";

/// Reads Parquet and Arrow IPC files with pyarrow in a Python of its own (column_rows.py), one process for all files:
/// a damaged file can end it, and nothing has to be linked. Starts with the first question.
class ColumnReader {
 public:
  explicit ColumnReader(std::vector<std::filesystem::path> files) : files_(std::move(files)) {}
  ~ColumnReader();
  ColumnReader(const ColumnReader&) = delete;
  ColumnReader& operator=(const ColumnReader&) = delete;

  const std::filesystem::path& file(std::size_t number) const { return files_[number]; }

  /// A block (column_block.h) without values: the columns of a file and the number of its rows. Thread-safe, as below.
  /// @throws InputError if there is no Python with pyarrow, or the file cannot be read
  std::string columns(std::size_t file);
  /// A block of rows first .. last - 1 with the values of some columns. @param columns  rising numbers
  std::string rows(std::size_t file, std::size_t first, std::size_t last, const std::vector<std::size_t>& columns);

 private:
  std::string ask(std::size_t file, const std::string& question);
  void start(std::size_t file);
  [[noreturn]] void refuse_end(std::size_t file);

  std::vector<std::filesystem::path> files_;
  std::mutex mutex_;
  pid_t process_ = 0;
  int socket_ = -1;
  MemoryFile messages_{"abbe-messages"};
};

}  // namespace abbe
