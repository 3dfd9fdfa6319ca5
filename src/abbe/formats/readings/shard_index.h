#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace abbe {

/// A file that is read in parts by several threads, without being mapped: memory does not grow with what was read.
class PartFile {
 public:
  explicit PartFile(const std::filesystem::path& path);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::size_t size() const { return size_; }
  /// Bytes begin .. end - 1. @throws InputError if the file has become shorter or cannot be read
  std::string read(std::size_t begin, std::size_t end) const;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::size_t size_ = 0;
};

/// Rows of one file that are parsed together.
struct ShardPart {
  std::size_t file = 0;
  std::size_t begin = 0, end = 0;  ///< bytes; of a column file rows
  std::size_t line = 0;            ///< of its first row, from 1
  std::size_t first = 0;           ///< number of its first reading among those of all files
  std::size_t count = 0;           ///< rows
  std::uint64_t bytes = 0;         ///< fingerprint
};

/// Where the rows of a file are.
struct ShardRows {
  std::string header;
  std::vector<ShardPart> parts;
  std::size_t count = 0;
  std::uint64_t content = 0;  ///< fingerprint of the whole file
};

/// @param number  of the file
/// @param first   number of its first reading; a part ends where the number of the next reading is a multiple of
///   `together`
/// @param read    called with the bytes that were read since the last call
/// @throws InputError if the file has no header or no row, or ends within a row
ShardRows find_rows(const PartFile& file, std::size_t number, std::size_t first, std::size_t together,
                    const std::function<void(std::size_t)>& read);

}  // namespace abbe
