#pragma once

#include <cstdint>
#include <filesystem>

namespace abbe {

/// What shows that a file has changed: its length and the time of its last change.
struct FileStamp {
  std::uint64_t bytes = 0;
  std::int64_t seconds = 0, nanoseconds = 0;

  bool operator==(const FileStamp&) const = default;
};

/// Zeros for a file that cannot be found.
FileStamp file_stamp(const std::filesystem::path& path);

}  // namespace abbe
