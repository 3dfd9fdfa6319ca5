#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "abbe/formats/interruption.h"

namespace abbe {

/// A file that is written piece by piece and appears whole or not at all; an older file of that name stays until then.
///
/// Until commit() the file has no name where the file system can do that, so that a killed or interrupted process
/// leaves nothing behind; elsewhere it is called "<name>.partial-<process>" and the next writer of that name removes
/// it.
class StreamedFile {
 public:
  /// @throws InputError if the file cannot be made
  explicit StreamedFile(const std::filesystem::path& path);
  ~StreamedFile();
  StreamedFile(const StreamedFile&) = delete;
  StreamedFile& operator=(const StreamedFile&) = delete;

  /// @throws InputError if it cannot be written whole
  void append(std::string_view contents);
  /// Writes over what was written before, such as a header whose numbers are known at the end. @throws InputError
  void overwrite(std::size_t offset, std::string_view contents);
  /// Flushes and makes the file visible under its name. @throws InputError; the older file is then still there
  void commit();

 private:
  std::filesystem::path path_, partial_;
  std::optional<UnfinishedPath> unfinished_;
  int file_ = -1;
  bool is_named_ = false;  ///< `partial_` exists
};

}  // namespace abbe
